//! A curve through a few known points that goes up and down only where they do.

/// Points of the drawn curve from one known point to the next.
const BETWEEN: usize = 24;

/// The known points, `x` strictly rising, joined by cubics with the slopes of Fritsch and Butland (harmonic means of
/// the slopes on both sides, weighted by the widths of the intervals; SIAM J. Sci. Stat. Comput. 5 (1984) 300): the
/// curve is monotone wherever the points are, and overshoots nowhere.
pub(super) fn through(x: &[f64], y: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let n = x.len().min(y.len());
    if n < 3 || x.windows(2).any(|w| w[1] <= w[0] || (w[1] - w[0]).is_nan()) {
        return (x[..n].to_vec(), y[..n].to_vec());
    }
    let width: Vec<f64> = x.windows(2).map(|w| w[1] - w[0]).collect();
    let slope: Vec<f64> = (0..n - 1).map(|i| (y[i + 1] - y[i]) / width[i]).collect();
    let mut tangent = vec![0.0; n];
    for i in 1..n - 1 {
        let (before, after) = (slope[i - 1], slope[i]);
        if before * after > 0.0 {
            let (a, b) = (2.0 * width[i] + width[i - 1], width[i] + 2.0 * width[i - 1]);
            tangent[i] = (a + b) / (a / before + b / after);
        }
    }
    tangent[0] = end(slope[0], slope[1], width[0], width[1]);
    tangent[n - 1] = end(slope[n - 2], slope[n - 3], width[n - 2], width[n - 3]);
    let (mut xs, mut ys) = (vec![x[0]], vec![y[0]]);
    for i in 0..n - 1 {
        for k in 1..=BETWEEN {
            let t = k as f64 / BETWEEN as f64;
            let rest = 1.0 - t;
            // Hermite's basis
            let value = rest * rest * (1.0 + 2.0 * t) * y[i]
                + t * t * (3.0 - 2.0 * t) * y[i + 1]
                + width[i] * t * rest * (rest * tangent[i] - t * tangent[i + 1]);
            xs.push(if k == BETWEEN { x[i + 1] } else { x[i] + t * width[i] });
            ys.push(if k == BETWEEN { y[i + 1] } else { value });
        }
    }
    (xs, ys)
}

/// The slope at an end: that of the parabola through three points, within what keeps the curve monotone.
fn end(own: f64, next: f64, width: f64, width_next: f64) -> f64 {
    let slope = ((2.0 * width + width_next) * own - width * next) / (width + width_next);
    if slope * own <= 0.0 {
        0.0
    } else if own * next <= 0.0 && slope.abs() > 3.0 * own.abs() {
        3.0 * own
    } else {
        slope
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn passes_through_the_points_and_stays_between_them() {
        let x = [0.0, 1.0, 1.5, 4.0, 4.2, 7.0];
        let y = [-3.0, -1.0, -0.9, 0.0, 2.0, 2.1];
        let (xs, ys) = through(&x, &y);
        assert_eq!(xs.len(), 5 * BETWEEN + 1);
        for (i, (x, y)) in x.iter().zip(&y).enumerate() {
            assert_eq!((xs[i * BETWEEN], ys[i * BETWEEN]), (*x, *y));
        }
        assert!(xs.windows(2).all(|w| w[1] > w[0]));
        assert!(ys.windows(2).all(|w| w[1] >= w[0]));
    }

    #[test]
    fn straight_lines_stay_straight_and_parabolas_nearly() {
        let x = [-2.0, -1.2, 0.0, 0.7, 2.0];
        let (xs, ys) = through(&x, &x.map(|x| 3.0 * x - 1.0));
        assert!(xs.iter().zip(&ys).all(|(x, y)| (y - (3.0 * x - 1.0)).abs() < 1e-14));
        let (xs, ys) = through(&x, &x.map(|x| (x + 3.0) * (x + 3.0)));
        let worst = xs.iter().zip(&ys).map(|(x, y)| (y - (x + 3.0) * (x + 3.0)).abs());
        assert!(worst.fold(0.0, f64::max) < 0.05);
    }

    #[test]
    fn two_points_or_unsorted_ones_stay_as_they_are() {
        assert_eq!(through(&[0.0, 1.0], &[2.0, 3.0]), (vec![0.0, 1.0], vec![2.0, 3.0]));
        let (x, y) = ([0.0, 0.0, 1.0], [1.0, 2.0, 3.0]);
        assert_eq!(through(&x, &y), (x.to_vec(), y.to_vec()));
        assert_eq!(through(&[], &[]), (vec![], vec![]));
    }
}
