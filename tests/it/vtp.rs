//! VTP files hold every field of every body, and open again.

use lahar::error::Status;
use lahar::output::vtk;
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
    vtk::write(&world, &path).expect("a written file");
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
    let (ids, body) = (array("id"), array("body"));
    for info in world.fields(first).expect("fields") {
        let name = info.name.to_str().expect("ASCII");
        let found = if name == "position" { points.clone() } else { array(name) };
        let width = if info.components == 2 { 3 } else { info.components };
        assert_eq!(found.len(), width * (n[0] + n[1]), "{name}");
        let expected = [first, second].map(|b| read(&world, b, name));
        for k in 0..n[0] + n[1] {
            for c in 0..info.components {
                let value = expected[body[k] as usize][ids[k] as usize * info.components + c];
                assert_eq!(found[k * width + c], value, "{name} of particle {k}");
            }
        }
    }
    std::fs::remove_dir_all(folder).expect("removed");
    let error = vtk::write(&world, "/no/such/folder/x.vtp".as_ref()).expect_err("no folder");
    assert_eq!(error.status, Status::File);
    assert!(error.message.contains("/no/such/folder/x.vtp"));
    let error = vtk::write(&world, "x.vtk".as_ref()).expect_err("wrong ending");
    assert!(error.status == Status::InvalidArgument && error.message.contains(".vtp"));
}

#[test]
fn points_are_in_the_order_of_ids_and_the_time_is_in_the_file() {
    let context = context(1);
    let material = elastic(&context, 1e5, 0.3);
    let options = Options { dimension: 2, spacing: 0.1, ..Options::default() };
    let mut world = world(&context, &options);
    let bodies = [[0.0, 0.0], [2.0, 1.0]].map(|[x, y]| {
        let region = a_box([x, y, 0.0], [x + 1.0, y + 1.0, 0.0]);
        fill(&mut world, &material, &region, 1000.0, [3.0, -2.0, 0.0])
    });
    let (_, done) = world.advance(0.3, 1_000_000);
    done.expect("a flight");
    let stored: Vec<i64> =
        bodies.iter().flat_map(|b| world.ids(*b).expect("a body")).copied().collect();
    let path = std::env::temp_dir().join(format!("lahar-order-{}.vtp", std::process::id()));
    vtk::write(&world, &path).expect("a written file");
    let DataSet::PolyData { pieces, .. } = Vtk::import(&path).expect("a VTP file").data else {
        panic!("a VTP file holds poly data");
    };
    let piece = pieces[0].load_piece_data(None).expect("an inline piece");
    let ids = piece.data.point.iter().find_map(|a| match a {
        Attribute::DataArray(d) if d.name == "id" => d.data.clone().cast_into::<i64>(),
        _ => None,
    });
    let n = stored.len() as i64 / 2;
    let ids = ids.expect("ids");
    assert_eq!(ids, (0..n).chain(0..n).collect::<Vec<i64>>());
    assert_ne!(ids, stored, "the flight must change the order of storage");
    let text = std::fs::read_to_string(&path).expect("XML");
    std::fs::remove_file(&path).expect("removed");
    let (_, rest) = text.split_once("<FieldData>").expect("field data");
    let (field, _) = rest.split_once("</FieldData>").expect("field data");
    assert!(field.contains("Name=\"TimeValue\" type=\"Float64\""), "{field}");
    let value = field.split(['>', '<']).find_map(|part| part.parse::<f64>().ok());
    assert_eq!(value, Some(world.time()), "{field}");
}
