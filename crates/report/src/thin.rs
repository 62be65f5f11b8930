//! Fewer points, the same picture: what a figure of a few hundred pixels can show of a million samples. All coordinates
//! here are pixels.

/// A place in the figure, x to the right and y down, in pixels.
pub(super) type Pixel = (f64, f64);

/// The most vertices a polyline keeps where it does not run from left to right.
const MOST_VERTICES: usize = 20_000;

/// So many markers are drawn one by one, however near each other they are.
const FEW_MARKERS: usize = 100;

/// A rectangle: left, top, right, bottom.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Frame {
    pub left: f64,
    pub top: f64,
    pub right: f64,
    pub bottom: f64,
}

impl Frame {
    pub fn contains(&self, (x, y): Pixel) -> bool {
        // Half a pixel of grace: a point on the edge of a given range is in it.
        x >= self.left - 0.5 && x <= self.right + 0.5 && y >= self.top - 0.5 && y <= self.bottom + 0.5
    }
}

/// The unbroken pieces of a line, thinned and cut to the frame. Non-finite vertices break it.
pub(super) fn polylines(vertices: impl Iterator<Item = Pixel>, frame: Frame) -> Vec<Vec<Pixel>> {
    let mut pieces = Vec::new();
    let mut piece = Vec::new();
    for v in vertices {
        if v.0.is_finite() && v.1.is_finite() {
            piece.push(v);
        } else if !piece.is_empty() {
            pieces.push(std::mem::take(&mut piece));
        }
    }
    pieces.push(piece);
    pieces.iter().flat_map(|p| clipped(&thinned(p), frame)).collect()
}

/// Along rightward lines the first, lowest, highest and last vertex of each half pixel; along others, what moves
/// by half a pixel, up to a bound.
fn thinned(piece: &[Pixel]) -> Vec<Pixel> {
    const CELL: f64 = 0.5;
    if piece.len() < 500 {
        return piece.to_vec();
    }
    if piece.windows(2).all(|w| w[1].0 >= w[0].0) {
        return envelope(piece, CELL);
    }
    let mut kept: Vec<Pixel> = Vec::new();
    for &v in piece {
        if kept.last().is_none_or(|k| (k.0 - v.0).abs() + (k.1 - v.1).abs() >= CELL) {
            kept.push(v);
        }
    }
    let stride = kept.len().div_ceil(MOST_VERTICES);
    kept.into_iter().step_by(stride.max(1)).collect()
}

fn envelope(piece: &[Pixel], cell: f64) -> Vec<Pixel> {
    let mut kept = Vec::new();
    for column in piece.chunk_by(|a, b| (a.0 / cell).floor() == (b.0 / cell).floor()) {
        let by_height = |a: &(usize, &Pixel), b: &(usize, &Pixel)| a.1.1.total_cmp(&b.1.1);
        let low = column.iter().enumerate().min_by(by_height).map_or(0, |(i, _)| i);
        let high = column.iter().enumerate().max_by(by_height).map_or(0, |(i, _)| i);
        let mut chosen = [0, low.min(high), low.max(high), column.len() - 1].to_vec();
        chosen.dedup();
        kept.extend(chosen.into_iter().map(|i| column[i]));
    }
    kept
}

/// The parts of a polyline inside the frame.
fn clipped(line: &[Pixel], frame: Frame) -> Vec<Vec<Pixel>> {
    let mut parts: Vec<Vec<Pixel>> = Vec::new();
    let mut open: Vec<Pixel> = Vec::new();
    for ends in line.windows(2) {
        let Some((from, to, leaves)) = segment(ends[0], ends[1], frame) else {
            close(&mut open, &mut parts);
            continue;
        };
        if open.last() != Some(&from) {
            close(&mut open, &mut parts);
            open.push(from);
        }
        open.push(to);
        if leaves {
            close(&mut open, &mut parts);
        }
    }
    close(&mut open, &mut parts);
    parts
}

fn close(open: &mut Vec<Pixel>, parts: &mut Vec<Vec<Pixel>>) {
    if open.len() > 1 {
        parts.push(std::mem::take(open));
    }
    open.clear();
}

/// The part of a segment inside the frame, and whether it leaves there (Liang and Barsky 1984).
fn segment(a: Pixel, b: Pixel, frame: Frame) -> Option<(Pixel, Pixel, bool)> {
    let (dx, dy) = (b.0 - a.0, b.1 - a.1);
    let (mut enter, mut leave) = (0.0f64, 1.0f64);
    let sides = [(-dx, a.0 - frame.left), (dx, frame.right - a.0), (-dy, a.1 - frame.top), (dy, frame.bottom - a.1)];
    for (direction, distance) in sides {
        if direction == 0.0 {
            if distance < 0.0 {
                return None;
            }
        } else if direction < 0.0 {
            enter = enter.max(distance / direction);
        } else {
            leave = leave.min(distance / direction);
        }
    }
    if enter > leave {
        return None;
    }
    let at = |t: f64| {
        if t == 0.0 {
            a
        } else if t == 1.0 {
            b
        } else {
            (a.0 + t * dx, a.1 + t * dy)
        }
    };
    Some((at(enter), at(leave), leave < 1.0))
}

/// Which of many markers to draw: one in each cell of a grid of half a pixel, or of a coarser one where more than `most`
/// would be left. A printed page holds every marker as a shape of its own. Indices in ascending order.
pub(super) fn markers(places: &[Pixel], most: usize) -> Vec<usize> {
    if places.len() <= most.min(FEW_MARKERS) {
        return (0..places.len()).collect();
    }
    let mut cell = 0.5;
    loop {
        let mut taken = std::collections::HashSet::new();
        let chosen: Vec<usize> = (0..places.len())
            .filter(|&i| {
                taken.len() <= most && taken.insert(((places[i].0 / cell) as i64, (places[i].1 / cell) as i64))
            })
            .collect();
        if chosen.len() <= most || cell > 64.0 {
            return chosen;
        }
        cell *= 1.4;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FRAME: Frame = Frame { left: 0.0, top: 0.0, right: 100.0, bottom: 50.0 };

    #[test]
    fn a_million_samples_keep_their_extremes() {
        let mut line: Vec<Pixel> =
            (0..1_000_000).map(|i| (f64::from(i) * 1e-4, 25.0 + 10.0 * (f64::from(i) * 0.37).sin())).collect();
        line[123_456].1 = 49.5;
        let parts = polylines(line.iter().copied(), FRAME);
        let kept: usize = parts.iter().map(Vec::len).sum();
        assert!(kept < 1300, "{kept}");
        assert!(parts.iter().flatten().any(|p| p.1 == 49.5));
    }

    #[test]
    fn lines_are_cut_at_the_frame_and_at_gaps() {
        let line =
            [(-10.0, 25.0), (10.0, 25.0), (50.0, 75.0), (90.0, 25.0), (f64::NAN, 0.0), (95.0, 10.0), (99.0, 10.0)];
        let parts = polylines(line.into_iter(), FRAME);
        assert_eq!(parts.len(), 3, "{parts:?}");
        assert_eq!(parts[0][0], (0.0, 25.0));
        assert!(parts.iter().flatten().all(|&p| FRAME.contains(p)));
        assert_eq!(parts[2], [(95.0, 10.0), (99.0, 10.0)]);
    }

    #[test]
    fn few_markers_stand_for_many() {
        let cloud: Vec<Pixel> = (0..200_000).map(|i| (f64::from(i % 997) / 10.0, f64::from(i % 499) / 10.0)).collect();
        let chosen = markers(&cloud, 3000);
        assert!((500..=3000).contains(&chosen.len()), "{}", chosen.len());
        assert!(chosen.is_sorted());
        assert_eq!(markers(&cloud[..10], 3000).len(), 10);
    }
}
