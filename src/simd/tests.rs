use super::*;

/// Every operation of the vectors of an instruction set against plain numbers.
struct Operations;

impl Kernel for Operations {
    type Output = ();
    #[inline(always)]
    fn run<V: Vector>(self) {
        let a: [f64; LANES] = [1.5, -2.25, 3.0, -0.0, 0.5, 1e9 + 0.75, -7.5, 8.0];
        let b: [f64; LANES] = [2.0, 4.0, -0.5, 1.0, 0.25, -3.0, 1.5, 8.0];
        let (x, y) = (V::load(&a), V::from_array(b));
        let check = |got: V, expected: fn(f64, f64) -> f64| {
            for (l, value) in got.to_array().into_iter().enumerate() {
                assert_eq!(value, expected(a[l], b[l]), "lane {l}");
            }
        };
        check(x + y, |a, b| a + b);
        check(x - y, |a, b| a - b);
        check(x * y, |a, b| a * b);
        check(x / y, |a, b| a / b);
        check(-x, |a, _| -a);
        check(x.floor(), |a, _| a.floor());
        check(x.abs(), |a, _| a.abs());
        check(x.abs().sqrt(), |a, _| a.abs().sqrt());
        check(x.max(y), f64::max);
        check(x.min(y), f64::min);
        check(x.mul_add(y, V::splat(0.5)), |a, b| a * b + 0.5); // all exact
        let mut sum = x;
        sum += y;
        check(sum, |a, b| a + b);
        assert_eq!(x.less_than(y), 0b0100_1011);
        assert_eq!(x.largest(), 1e9 + 0.75);
        assert_eq!(y.sum(), b.iter().sum::<f64>());
        assert_eq!(V::halves(1.0, 2.0).to_array(), [1.0, 1.0, 1.0, 1.0, 2.0, 2.0, 2.0, 2.0]);
        assert_eq!(V::load(&[0.0, 7.0, 1e6, 3.9, 5.0]).to_indices()[..5], [0, 7, 1_000_000, 3, 5]);
        let [low, high] = [[1.0, 2.0, 3.0, 4.0], [5.0, 6.0, 7.0, 8.0]];
        assert_eq!(V::join(&low, &high).to_array(), [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0]);
        let mut node = TileNode::default();
        x.store_node(&mut node);
        assert_eq!(V::load_node(&node).to_array(), a);
        not_a_number::<V>();
        transposed::<V>();
        parts::<V>();
    }
}

#[inline(always)]
fn not_a_number<V: Vector>() {
    let nan = V::splat(f64::NAN);
    assert_eq!(nan.less_than(V::splat(1.0)), 0);
    assert!(nan.floor().to_array().iter().all(|x| !x.is_finite()));
    assert!(V::splat(f64::INFINITY).floor().to_array().iter().all(|x| !x.is_finite()));
    assert!(nan.sum().is_nan());
}

#[inline(always)]
fn transposed<V: Vector>() {
    let number = |r: usize, l: usize| (10 * r + l) as f64;
    let rows = std::array::from_fn(|r| V::from_array(std::array::from_fn(|l| number(r, l))));
    for (l, row) in V::transpose(rows).into_iter().enumerate() {
        assert_eq!(row.to_array(), std::array::from_fn(|r| number(r, l)));
    }
}

/// Slices that are shorter or longer than a vector.
#[inline(always)]
fn parts<V: Vector>() {
    let numbers: [f64; 12] = std::array::from_fn(|n| n as f64 + 1.0);
    for n in 0..numbers.len() {
        let lanes = V::load(&numbers[..n]).to_array();
        for (l, lane) in lanes.into_iter().enumerate() {
            assert_eq!(lane, if l < n { numbers[l] } else { 0.0 });
        }
        let mut room = [-1.0; 12];
        V::splat(5.0).store(&mut room[..n]);
        for (l, value) in room.into_iter().enumerate() {
            assert_eq!(value, if l < n.min(LANES) { 5.0 } else { -1.0 });
        }
    }
}

#[test]
fn the_lanes_of_every_instruction_set_calculate_like_numbers() {
    for isa in Isa::all() {
        isa.dispatch(Operations);
    }
}

#[test]
fn the_floor_of_a_number_is_that_of_the_library() {
    for x in [0.0, -0.0, 0.5, -0.5, 1.0, -1.0, 2.5, -2.5, 1e9 + 0.75, -1e9 - 0.25, -1e-300] {
        assert_eq!(Real::floor(x), f64::floor(x), "{x}");
        assert_eq!(Real::floor(f64::next_down(x)), f64::next_down(x).floor(), "below {x}");
    }
    assert!(!Real::floor(f64::NAN).is_finite() && !Real::floor(f64::INFINITY).is_finite());
}

#[test]
fn an_instruction_set_is_found_by_its_name_or_refused() {
    for isa in Isa::all() {
        assert_eq!(Isa::named(isa.name()).expect("the processor has it"), isa);
    }
    assert_eq!(Isa::named("scalar").expect("every processor has it").name(), "scalar");
    let error = Isa::named("avx3").expect_err("no such name");
    assert!(error.message.contains("scalar") && error.message.contains("avx3"), "{error}");
}
