//! The plots of the report: lines, dots, and errors over cells on logarithmic axes.

use lahar_verification::case::{Case, Curve, Plot};
use plotters::coord::ranged1d::{AsRangedCoord, ValueFormatter};
use plotters::prelude::*;

use super::store::{Kept, folder};
use lahar_picture::{FONT, register_font};

const SIZE: (u32, u32) = (960, 400);
const LEGEND: u32 = 300; // pixels at the right

/// Colours that people with colour blindness can distinguish (Okabe and Ito, 2008).
const COLOURS: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(0, 0, 0),
];

type Points = Vec<(f64, f64)>;
type Failure = Box<dyn std::error::Error>;

/// Draws the plots of a case; gives the names of the files relative to `docs/`.
pub fn draw(case: &Case, kept: &Kept) -> Result<Vec<String>, String> {
    register_font()?;
    let mut names = Vec::new();
    for (number, plot) in case.plots.iter().enumerate() {
        let name = if number == 0 {
            format!("{}.png", case.case.to_lowercase())
        } else {
            format!("{}_{}.png", case.case.to_lowercase(), number + 1)
        };
        let curves: Vec<(String, bool, Points)> =
            plot.curves.iter().filter_map(|curve| points(case, kept, plot, curve)).collect();
        if curves.is_empty() {
            continue;
        }
        let file = folder().join(&name);
        let bounds = |axis: fn(&(f64, f64)) -> f64| {
            let values = curves.iter().flat_map(|curve| &curve.2).map(axis);
            values.fold((f64::INFINITY, f64::NEG_INFINITY), |b, v| (b.0.min(v), b.1.max(v)))
        };
        let (x, y) = (bounds(|p| p.0), bounds(|p| p.1));
        let drawn = if plot.log {
            let wide = |(low, high): (f64, f64)| (low / 1.25..high * 1.25).log_scale();
            chart(&file, plot, &curves, (wide(x), wide(y)))
        } else {
            let (pad_x, pad_y) = (0.02 * (x.1 - x.0), 0.08 * (y.1 - y.0).max(1e-12));
            let x = x.0 - pad_x..x.1 + pad_x;
            chart(&file, plot, &curves, (x, y.0 - pad_y..y.1 + pad_y))
        };
        drawn.map_err(|e| format!("{}: {e}", file.display()))?;
        names.push(format!("verification/{name}"));
    }
    Ok(names)
}

/// Label and points of a curve, if its runs were done.
fn points(case: &Case, kept: &Kept, plot: &Plot, curve: &Curve) -> Option<(String, bool, Points)> {
    let outcome =
        |name: &str| kept.runs.iter().find(|run| run.name == name).map(|run| &run.outcome);
    let label = if curve.label.is_empty() { curve.run.clone() } else { curve.label.clone() };
    let mut points: Points = if curve.runs.is_empty() {
        outcome(&curve.run)?.series.get(&curve.series)?.iter().map(|p| (p[0], p[1])).collect()
    } else {
        let of = |name: &String| {
            Some((case.cells_of(name).ok()?, (*outcome(name)?.quantities.get(&curve.quantity)?)?))
        };
        curve.runs.iter().filter_map(of).collect()
    };
    if plot.log {
        points.iter_mut().for_each(|p| p.1 = p.1.abs());
        points.retain(|p| p.0 > 0.0 && p.1 > 0.0);
    }
    (!points.is_empty()).then_some((label, curve.dots, points))
}

fn chart<X, Y>(
    file: &std::path::Path,
    plot: &Plot,
    curves: &[(String, bool, Points)],
    (x, y): (X, Y),
) -> Result<(), Failure>
where
    X: AsRangedCoord<Value = f64>,
    Y: AsRangedCoord<Value = f64>,
    X::CoordDescType: ValueFormatter<f64> + Ranged<ValueType = f64>,
    Y::CoordDescType: ValueFormatter<f64> + Ranged<ValueType = f64>,
{
    let root = BitMapBackend::new(file, SIZE).into_drawing_area();
    root.fill(&WHITE)?;
    let (body, legend) = root.split_horizontally(SIZE.0 - LEGEND);
    let mut chart = ChartBuilder::on(&body)
        .caption(&plot.title, (FONT, 20))
        .margin(12)
        .x_label_area_size(42)
        .y_label_area_size(72)
        .build_cartesian_2d(x, y)?;
    let short = |value: &f64| short(*value);
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(RGBColor(225, 225, 225))
        .x_desc(&plot.x)
        .y_desc(&plot.y)
        .x_label_formatter(&short)
        .y_label_formatter(&short)
        .label_style((FONT, 14))
        .axis_desc_style((FONT, 16))
        .draw()?;
    for (number, (label, dots, points)) in curves.iter().enumerate() {
        let colour = COLOURS[number % COLOURS.len()];
        let style = colour.stroke_width(2);
        if *dots || plot.log {
            chart.draw_series(points.iter().map(|p| Circle::new(*p, 4, colour.filled())))?;
        }
        if !*dots {
            chart.draw_series(LineSeries::new(points.iter().copied(), style))?;
        }
        let y = 40 + 22 * number as i32;
        legend.draw(&Rectangle::new([(0, y + 5), (18, y + 9)], colour.filled()))?;
        legend.draw(&Text::new(label.as_str(), (26, y), (FONT, 15)))?;
    }
    root.present()?;
    Ok(())
}

/// A number for an axis.
fn short(value: f64) -> String {
    let size = value.abs();
    if size < 1e-12 {
        "0".to_string()
    } else if (1e-3..1e5).contains(&size) {
        let text = format!("{value:.4}");
        text.trim_end_matches('0').trim_end_matches('.').to_string()
    } else {
        format!("{value:.0e}")
    }
}
