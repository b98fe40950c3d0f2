//! Crossings of the sides of outlines, counted before an outline is split at them: their number can grow with the
//! square of the number of sides.

use i_overlay::i_float::int::point::IntPoint;

/// A place on the grid of outlines.
pub(super) type Grid = IntPoint<i32>;

/// Pairs of sides that are looked at, at most.
const MOST_PAIRS: usize = 400_000_000;

/// Number of pairs of sides of closed loops that cross, touch or lie on each other, without ends that they share;
/// `None` for more than `most`, and where finding them takes too long.
pub(super) fn crossings<'a>(
    loops: impl Iterator<Item = &'a Vec<Grid>>,
    most: usize,
) -> Option<usize> {
    let sides = |one: &'a Vec<Grid>| one.iter().zip(one.iter().cycle().skip(1));
    let along_x = |(a, b): (&Grid, &Grid)| {
        if (a.x, a.y) <= (b.x, b.y) {
            [*a, *b]
        } else {
            [*b, *a]
        }
    };
    let mut sides: Vec<[Grid; 2]> = loops.flat_map(sides).map(along_x).collect();
    sides.sort_unstable_by_key(|[a, _]| a.x);
    let (mut found, mut pairs) = (0, 0);
    for (i, one) in sides.iter().enumerate() {
        for other in sides[i + 1..].iter().take_while(|[a, _]| a.x <= one[1].x) {
            pairs += 1;
            found += usize::from(meet(*one, *other));
            if found > most || pairs > MOST_PAIRS {
                return None;
            }
        }
    }
    Some(found)
}

/// Whether sides meet elsewhere than at an end that both have.
fn meet([a, b]: [Grid; 2], [c, d]: [Grid; 2]) -> bool {
    let range = |p: Grid, q: Grid| (p.y.min(q.y), p.y.max(q.y));
    let ((low, high), (other_low, other_high)) = (range(a, b), range(c, d));
    if low > other_high || other_low > high || b.x < c.x {
        return false;
    }
    // No overflow: coordinates have at most 28 bits.
    let turn = |p: Grid, q: Grid, r: Grid| {
        let [px, py, qx, qy, rx, ry] = [p.x, p.y, q.x, q.y, r.x, r.y].map(i64::from);
        ((qx - px) * (ry - py) - (qy - py) * (rx - px)).signum()
    };
    let (c_side, d_side) = (turn(a, b, c), turn(a, b, d));
    let (a_side, b_side) = (turn(c, d, a), turn(c, d, b));
    let is_shared = a == c || a == d || b == c || b == d;
    match is_shared {
        // On one line, in the same direction from the end that both have: ends are ordered along x.
        true => c_side == 0 && d_side == 0 && (a == c || b == d),
        false => c_side * d_side <= 0 && a_side * b_side <= 0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn loop_of(points: &[[i32; 2]]) -> Vec<Grid> {
        points.iter().map(|[x, y]| Grid::new(*x, *y)).collect()
    }

    #[test]
    fn sides_that_meet_are_counted() {
        let square = [[0, 0], [4, 0], [4, 4], [0, 4]];
        let bow = [[0, 0], [4, 4], [4, 0], [0, 4]];
        let spikes = [[0, 0], [5, 0], [0, 0], [7, 0], [0, 0], [0, 9]];
        let touching = [[0, 0], [8, 0], [8, 4], [4, 0], [0, 4]];
        for (points, count) in [(&square[..], 0), (&bow, 1), (&spikes, 7), (&touching, 2)] {
            assert_eq!(
                crossings([&loop_of(points)].into_iter(), 100),
                Some(count),
                "{points:?}"
            );
        }
        assert_eq!(crossings([&loop_of(&bow)].into_iter(), 0), None);
        let two = [loop_of(&square), loop_of(&[[2, 2], [9, 2], [9, 3]])];
        assert_eq!(crossings(two.iter(), 100), Some(2));
    }
}
