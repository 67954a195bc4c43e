//! VTP files hold every field of every body, and open again.

use lahar::error::Status;
use lahar::particles::seeding::Region;
use lahar::world::options::Options;
use vtkio::model::{Attribute, DataSet, Vtk};

use crate::setup::{a_box, context, elastic, fill, read, world};

#[test]
fn a_vtp_file_opens_again_with_every_field() {
    let context = context(1);
    let material = elastic(&context, 1e5, 0.3);
    let options = Options { dimension: 2, spacing: 0.1, ..Options::default() };
    let mut world = world(&context, &options);
    let region = a_box([0.0; 3], [0.4, 0.3, 0.0]);
    let first = fill(&mut world, &material, &region, 1000.0, [1.0, 2.0, 0.0]);
    let disc = Region::Sphere { center: [2.0, 2.0, 0.0], radius: 0.3 };
    let second = fill(&mut world, &material, &disc, 500.0, [0.0; 3]);
    world.step(None).expect("a step");
    let folder = std::env::temp_dir().join(format!("lahar-vtp-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a temporary folder");
    let path = folder.join("two.vtp");
    world.write_vtp(&path).expect("a written file");
    let text = std::fs::read_to_string(&path).expect("XML");
    assert!(text.contains("vtkZLibDataCompressor"), "the file must be compressed");
    let DataSet::PolyData { pieces, .. } = Vtk::import(&path).expect("a VTP file").data else {
        panic!("a VTP file holds poly data");
    };
    let piece = pieces[0].load_piece_data(None).expect("an inline piece");
    let points = piece.points.cast_into::<f64>().expect("doubles");
    let n = [first, second].map(|b| world.particle_count(b).expect("a body"));
    assert_eq!(points.len(), 3 * (n[0] + n[1]));
    let array = |name: &str| {
        let found = piece.data.point.iter().find_map(|a| match a {
            Attribute::DataArray(d) if d.name == name => d.data.clone().cast_into::<f64>(),
            _ => None,
        });
        found.unwrap_or_else(|| panic!("no array `{name}`"))
    };
    for info in world.fields(first).expect("fields") {
        let name = info.name.to_str().expect("ASCII");
        if name != "position" {
            assert_eq!(array(name).len() % (n[0] + n[1]), 0);
        }
    }
    let (ids, mass, body) = (array("id"), array("mass"), array("body"));
    let expected = [first, second].map(|b| read(&world, b, "mass"));
    for k in 0..n[0] + n[1] {
        let b = body[k] as usize;
        assert_eq!(mass[k], expected[b][ids[k] as usize]);
    }
    std::fs::remove_dir_all(folder).expect("removed");
    let error = world.write_vtp("/no/such/folder/x.vtp".as_ref()).expect_err("no folder");
    assert_eq!(error.status, Status::File);
    assert!(error.message.contains("/no/such/folder/x.vtp"));
    assert!(world.write_vtp("x.vtk".as_ref()).expect_err("wrong ending").message.contains(".vtp"));
}
