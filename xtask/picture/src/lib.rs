//! Reads particle frames and draws them, coloured by speed.

use plotters::prelude::*;
use std::path::{Path, PathBuf};
use vtkio::model::{Attribute, Attributes, DataSet, IOBuffer, PolyDataPiece};

/// The particles of one instant.
#[derive(Default)]
pub struct Frame {
    /// Time [s].
    pub time: f64,
    /// Positions, `[x, y]` per particle [m].
    pub position: Vec<[f64; 2]>,
    /// Speed of each particle [m/s].
    pub speed: Vec<f64>,
}

/// The font of all pictures, once it is registered.
pub const FONT: &str = "sans-serif";
const PANEL_WIDTH: u32 = 760; // pixels, axis labels and margins included
const LEFT: u32 = 56;
const BOTTOM: u32 = 44;
const CAPTION: u32 = 34;
const MARGIN: u32 = 10;
const BAR_WIDTH: u32 = 120;
const COLUMNS: usize = 2;

/// Nine evenly spaced colours of the viridis map (van der Walt and Smith, 2015).
const VIRIDIS: [[u8; 3]; 9] = [
    [68, 1, 84],
    [71, 44, 122],
    [59, 81, 139],
    [44, 113, 142],
    [33, 144, 141],
    [39, 173, 129],
    [92, 200, 99],
    [170, 220, 50],
    [253, 231, 37],
];

/// Reads `folder/*.vtp` in the order of their times.
pub fn read_frames(folder: &Path) -> Result<Vec<Frame>, String> {
    let listing = std::fs::read_dir(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let files = listing
        .filter_map(|entry| entry.ok().map(|entry| entry.path()))
        .filter(|path| path.extension().is_some_and(|extension| extension == "vtp"));
    let read = |file: PathBuf| read_frame(&file).map_err(|e| format!("{}: {e}", file.display()));
    let mut frames = files.map(read).collect::<Result<Vec<_>, _>>()?;
    if frames.is_empty() {
        return Err(format!("there is no .vtp file in {}", folder.display()));
    }
    frames.sort_by(|a, b| a.time.total_cmp(&b.time));
    Ok(frames)
}

/// At most `count` frames, evenly spread, the first and the last among them.
pub fn spread(mut frames: Vec<Frame>, count: usize) -> Vec<Frame> {
    let last = frames.len().saturating_sub(1);
    if frames.len() <= count {
        return frames;
    }
    let wanted: Vec<usize> = (0..count).map(|i| i * last / (count - 1)).collect();
    let mut index = 0;
    frames.retain(|_| {
        index += 1;
        wanted.contains(&(index - 1))
    });
    frames
}

/// The field data `TimeValue`, which vtkio skips.
fn time_of(text: &str) -> Option<f64> {
    let (_, rest) = text.split_once("\"TimeValue\"")?;
    let (_, rest) = rest.split_once('>')?;
    rest.split('<').next()?.trim().parse().ok()
}

fn read_frame(file: &Path) -> Result<Frame, String> {
    let text = std::fs::read_to_string(file).map_err(|e| e.to_string())?;
    let time = time_of(&text).ok_or("expected the time as field data `TimeValue`")?;
    let vtk = vtkio::Vtk::parse_xml(text.as_bytes()).map_err(|e| e.to_string())?;
    let DataSet::PolyData { pieces, .. } = vtk.data else {
        return Err("expected PolyData".to_string());
    };
    let mut frame = Frame { time, ..Frame::default() };
    for piece in pieces {
        let piece: PolyDataPiece =
            piece.into_loaded_piece_data(Some(file)).map_err(|e| e.to_string())?;
        let velocity = triples(point_array(&piece.data, "velocity")?.clone())?;
        frame.speed.extend(velocity.iter().map(|v| v[0].hypot(v[1]).hypot(v[2])));
        frame.position.extend(triples(piece.points)?.iter().map(|x| [x[0], x[1]]));
    }
    if frame.position.len() != frame.speed.len() {
        let (points, speeds) = (frame.position.len(), frame.speed.len());
        return Err(format!("{points} points but {speeds} velocities"));
    }
    Ok(frame)
}

fn point_array<'a>(data: &'a Attributes, name: &str) -> Result<&'a IOBuffer, String> {
    data.point
        .iter()
        .find_map(|attribute| match attribute {
            Attribute::DataArray(array) if array.name == name => Some(&array.data),
            _ => None,
        })
        .ok_or_else(|| format!("there is no point array named {name}"))
}

fn triples(buffer: IOBuffer) -> Result<Vec<[f64; 3]>, String> {
    let flat: Vec<f64> = buffer.cast_into().ok_or("an array does not hold numbers")?;
    let (rows, rest) = flat.as_chunks();
    if rest.is_empty() { Ok(rows.to_vec()) } else { Err("expected three components".to_string()) }
}

/// Draws the frames as panels with equal scales of both axes, and a colour bar.
pub fn draw(frames: &[Frame], file: &Path) -> Result<(), String> {
    register_font()?;
    draw_panels(frames, file).map_err(|e| format!("{}: {e}", file.display()))
}

/// Brings the font along, so that none of the system is needed.
pub fn register_font() -> Result<(), String> {
    plotters::style::register_font(FONT, FontStyle::Normal, epaint_default_fonts::UBUNTU_LIGHT)
        .map_err(|_| "the font cannot be read".to_string())
}

fn draw_panels(frames: &[Frame], file: &Path) -> Result<(), Box<dyn std::error::Error>> {
    let reach = |axis: usize| {
        frames.iter().flat_map(|f| &f.position).map(|x| x[axis]).fold(0.0, f64::max) * 1.04
    };
    let (width, height) = (reach(0), reach(1));
    let top_speed = quantile(frames.iter().flat_map(|f| &f.speed).copied().collect(), 0.995);

    let plot_width = PANEL_WIDTH - LEFT - 2 * MARGIN;
    let plot_height = (f64::from(plot_width) * height / width).round() as u32;
    let panel_height = plot_height + CAPTION + BOTTOM + 2 * MARGIN;
    let rows = frames.len().div_ceil(COLUMNS);
    let size = (COLUMNS as u32 * PANEL_WIDTH + BAR_WIDTH, rows as u32 * panel_height);

    let root = BitMapBackend::new(file, size).into_drawing_area();
    root.fill(&WHITE)?;
    let (body, bar) = root.split_horizontally(COLUMNS as u32 * PANEL_WIDTH);
    for (frame, panel) in frames.iter().zip(body.split_evenly((rows, COLUMNS))) {
        let mut chart = ChartBuilder::on(&panel)
            .caption(format!("t = {:.2} s", frame.time), (FONT, 22))
            .margin(MARGIN)
            .x_label_area_size(BOTTOM)
            .y_label_area_size(LEFT)
            .build_cartesian_2d(0.0..width, 0.0..height)?;
        chart
            .configure_mesh()
            .disable_mesh()
            .x_desc("x [m]")
            .y_desc("y [m]")
            .label_style((FONT, 15))
            .axis_desc_style((FONT, 17))
            .draw()?;
        let dots = frame.position.iter().zip(&frame.speed);
        chart.draw_series(
            dots.map(|(x, speed)| Circle::new((x[0], x[1]), 2, colour(speed / top_speed).filled())),
        )?;
    }
    draw_bar(&bar, top_speed)?;
    root.present()?;
    Ok(())
}

fn draw_bar<B: DrawingBackend>(
    area: &DrawingArea<B, plotters::coord::Shift>,
    top_speed: f64,
) -> Result<(), Box<dyn std::error::Error>>
where
    B::ErrorType: 'static,
{
    let mut chart = ChartBuilder::on(area)
        .margin(MARGIN)
        .margin_top(60)
        .margin_bottom(60)
        .set_label_area_size(LabelAreaPosition::Right, 64)
        .build_cartesian_2d(0.0..1.0, 0.0..top_speed)?;
    let step = top_speed / 256.0;
    chart.draw_series((0..256).map(|i| {
        let y = f64::from(i) * step;
        Rectangle::new([(0.0, y), (1.0, y + step)], colour(y / top_speed).filled())
    }))?;
    chart
        .configure_mesh()
        .disable_mesh()
        .disable_x_axis()
        .y_desc("speed [m/s]")
        .label_style((FONT, 15))
        .axis_desc_style((FONT, 17))
        .draw()?;
    Ok(())
}

/// Colour of a value in 0 to 1; larger values take the last colour.
fn colour(value: f64) -> RGBColor {
    let position = value.clamp(0.0, 1.0) * (VIRIDIS.len() - 1) as f64;
    let first = (position as usize).min(VIRIDIS.len() - 2);
    let part = position - first as f64;
    let mix = |a: u8, b: u8| (f64::from(a) * (1.0 - part) + f64::from(b) * part).round() as u8;
    let (a, b) = (VIRIDIS[first], VIRIDIS[first + 1]);
    RGBColor(mix(a[0], b[0]), mix(a[1], b[1]), mix(a[2], b[2]))
}

/// The value below which the share `q` of the numbers lies; 1 if they are all 0, so that one can
/// divide by it.
fn quantile(mut numbers: Vec<f64>, q: f64) -> f64 {
    numbers.sort_by(f64::total_cmp);
    let index = (q * (numbers.len().saturating_sub(1)) as f64) as usize;
    numbers.get(index).copied().filter(|value| *value > 0.0).unwrap_or(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_time_is_found() {
        let text = "<DataArray Name=\"TimeValue\" format=\"ascii\">2.5e-1</DataArray>";
        assert_eq!(time_of(text), Some(0.25));
        assert_eq!(time_of("<DataArray Name=\"id\">1</DataArray>"), None);
    }

    #[test]
    fn a_spread_keeps_the_first_and_the_last_frame() {
        let frames = (0..11).map(|i| Frame { time: f64::from(i), ..Frame::default() }).collect();
        let times: Vec<f64> = spread(frames, 6).iter().map(|frame| frame.time).collect();
        assert_eq!(times, [0.0, 2.0, 4.0, 6.0, 8.0, 10.0]);
    }

    #[test]
    fn a_quantile_leaves_the_largest_out() {
        let numbers = (0..=1000).map(f64::from).collect();
        assert_eq!(quantile(numbers, 0.99), 990.0);
        assert_eq!(quantile(vec![0.0; 4], 0.99), 1.0);
    }

    #[test]
    fn panels_are_drawn_without_fonts_of_the_system() {
        let frame = |i: usize| Frame {
            time: i as f64,
            position: (0..4000).map(|k| [f64::from(k % 80), f64::from(k / 80)]).collect(),
            speed: (0..4000).map(|k| f64::from(k % 80) * i as f64).collect(),
        };
        let file = std::env::temp_dir().join(format!("lahar_picture_{}.png", std::process::id()));
        draw(&[frame(0), frame(1), frame(2)], &file).unwrap();
        assert!(std::fs::metadata(&file).unwrap().len() > 10_000);
        std::fs::remove_file(&file).unwrap();
    }
}
