//! Two elastic discs collide (verification case D1; D. Sulsky, Z. Chen, H. L. Schreyer 1994): r = 0.2 m at (0.2, 0.2) and (0.8, 0.8),
//! E = 1000 Pa, ν = 0.3, ρ = 1000 kg/m³, v = ±(0.1, 0.1) m/s, 2×2 particles a cell, h = 0.05 m, t = 3.5 s.

use lahar::particles::seeding::Region;
use lahar::step::StepOrder;
use lahar::transfer::TransferKind;
use lahar::world::options::Options;

use crate::setup::{context, elastic, fill, read, world};

struct Collision {
    /// Largest momentum over Σ |m v| at the start.
    momentum: f64,
    /// Smallest and largest (K + U) / K0, and the last.
    energy: [f64; 3],
    /// K / K0 at the end, its minimum and when.
    kinetic: [f64; 3],
    /// Smallest distance of particles of different discs at the end [m].
    gap: f64,
}

fn collide(transfer: TransferKind, pic_rate: f64, order: StepOrder) -> Collision {
    let context = context(1);
    let material = elastic(&context, 1000.0, 0.3);
    let h = 0.05;
    let options = Options {
        dimension: 2,
        spacing: h,
        transfer,
        pic_rate,
        order,
        cfl: 0.2,
        ..Options::default()
    };
    let mut world = world(&context, &options);
    let bodies = [0.2, 0.8].map(|c| {
        let v = 0.1 * f64::signum(0.5 - c);
        let disc = Region::Sphere { center: [c, c, 0.0], radius: 0.2 };
        fill(&mut world, &material, &disc, 1000.0, [v, v, 0.0])
    });
    let start = world.totals(None).expect("totals");
    let scale = start.mass * 0.02_f64.sqrt();
    let k0 = start.kinetic_energy;
    let mut out = Collision {
        momentum: 0.0,
        energy: [f64::INFINITY, 0.0, 0.0],
        kinetic: [0.0, f64::INFINITY, 0.0],
        gap: 0.0,
    };
    while world.time() < 3.5 {
        world.advance(3.5, 1).1.expect("a collision");
        let t = world.totals(None).expect("totals");
        let (k, e) = (t.kinetic_energy / k0, (t.kinetic_energy + t.strain_energy) / k0);
        out.momentum = t.momentum.iter().fold(out.momentum, |m, p| m.max(p.abs() / scale));
        out.energy = [out.energy[0].min(e), out.energy[1].max(e), e];
        out.kinetic[0] = k;
        if k < out.kinetic[1] {
            (out.kinetic[1], out.kinetic[2]) = (k, world.time());
        }
    }
    let [a, b] = bodies.map(|body| read(&world, body, "position"));
    let distance = |p: &[f64], q: &[f64]| (p[0] - q[0]).hypot(p[1] - q[1]);
    out.gap = a
        .chunks(2)
        .flat_map(|p| b.chunks(2).map(move |q| distance(p, q)))
        .fold(f64::INFINITY, f64::min);
    out
}

impl Collision {
    /// Whether energy and rebound are those of an elastic collision.
    fn is_elastic(&self) -> bool {
        self.energy[0] >= 0.98
            && self.energy[1] <= 1.02
            && self.kinetic[0] >= 0.8
            && self.gap >= 2.0 * 0.05
    }

    fn print(&self, name: &str) {
        println!(
            "{name}: momentum {:e}, (K+U)/K0 in [{:.4}, {:.4}], end {:.4}, K_end/K0 {:.4}, K_min/K0 {:.4} at {:.3} s, gap {:.4} m",
            self.momentum,
            self.energy[0],
            self.energy[1],
            self.energy[2],
            self.kinetic[0],
            self.kinetic[1],
            self.kinetic[2],
            self.gap
        );
    }
}

#[test]
fn quadratic_flip_discs_rebound_elastically() {
    let flip = collide(TransferKind::PicFlip, 0.0, StepOrder::Musl);
    flip.print("FLIP MUSL");
    assert!(flip.momentum <= 1e-12, "momentum {:e}", flip.momentum);
    assert!(flip.is_elastic());
}

#[test]
fn pic_discs_fail_the_gate_of_an_elastic_rebound() {
    let pic = collide(TransferKind::PicFlip, f64::INFINITY, StepOrder::Musl);
    pic.print("PIC MUSL");
    assert!(!pic.is_elastic());
    assert!(pic.momentum <= 1e-12, "momentum {:e}", pic.momentum);
    let apic = collide(TransferKind::Apic, 0.0, StepOrder::Musl);
    apic.print("APIC MUSL");
    assert!(apic.momentum <= 1e-12, "momentum {:e}", apic.momentum);
}
