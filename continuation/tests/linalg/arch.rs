//! A pencil like those of shells, for tests and benches.

use continuation::linalg::SymmetricBand;

/// Curved beam of unit length, clamped: membrane and bending energy of cubic elements, four
/// unknowns `(u, u', w, w')` per node, under a compression `load`; and its mass matrix.
pub(crate) fn arch(elements: usize, load: f64) -> (SymmetricBand, SymmetricBand) {
    let n = 4 * (elements - 1);
    let (mut a, mut m) = (SymmetricBand::new(n, 7), SymmetricBand::new(n, 7));
    let h = 1.0 / elements as f64;
    let (curvature, stiffness) = (2.0, 1e-4);
    let root = 0.6_f64.sqrt();
    for e in 0..elements {
        for (t, weight) in [(-root, 5.0 / 9.0), (0.0, 8.0 / 9.0), (root, 5.0 / 9.0)] {
            let (s, weight) = (0.5 * (1.0 + t), 0.5 * h * weight);
            let value = [
                1.0 - 3.0 * s * s + 2.0 * s * s * s,
                h * s * (1.0 - s) * (1.0 - s),
                s * s * (3.0 - 2.0 * s),
                h * s * s * (s - 1.0),
            ];
            let slope = [
                6.0 * s * (s - 1.0) / h,
                (1.0 - s) * (1.0 - 3.0 * s),
                6.0 * s * (1.0 - s) / h,
                s * (3.0 * s - 2.0),
            ];
            let bend = [
                (12.0 * s - 6.0) / (h * h),
                (6.0 * s - 4.0) / h,
                (6.0 - 12.0 * s) / (h * h),
                (6.0 * s - 2.0) / h,
            ];
            // shape k of the element belongs to node e + k / 2
            let unknown = |field: usize, k: usize| {
                (4 * (e + k / 2) + 2 * field + k % 2).checked_sub(4).filter(|i| *i < n)
            };
            for p in 0..8 {
                for q in 0..=p {
                    let (fp, kp, fq, kq) = (p / 4, p % 4, q / 4, q % 4);
                    let (Some(i), Some(j)) = (unknown(fp, kp), unknown(fq, kq)) else { continue };
                    let strain = |f: usize, k: usize| {
                        if f == 0 { slope[k] } else { curvature * value[k] }
                    };
                    let mut energy = strain(fp, kp) * strain(fq, kq);
                    if fp == 1 && fq == 1 {
                        energy += stiffness * bend[kp] * bend[kq] - load * slope[kp] * slope[kq];
                    }
                    a.add(i.max(j), i.min(j), weight * energy);
                    if fp == fq {
                        m.add(i.max(j), i.min(j), weight * value[kp] * value[kq]);
                    }
                }
            }
        }
    }
    (a, m)
}
