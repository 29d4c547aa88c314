//! Body axes in the world, of roll, pitch and yaw.

/// Rows of the matrix from body to world: north, east, down.
pub fn rows(attitude: [f64; 3]) -> [[f64; 3]; 3] {
    let [(sr, cr), (sp, cp), (sy, cy)] = attitude.map(f64::sin_cos);
    [
        [cp * cy, sr * sp * cy - cr * sy, cr * sp * cy + sr * sy],
        [cp * sy, sr * sp * sy + cr * cy, cr * sp * sy - sr * cy],
        [-sp, sr * cp, cr * cp],
    ]
}

/// A vector of the world in body axes.
pub fn to_body(attitude: [f64; 3], v: [f64; 3]) -> [f64; 3] {
    let rows = rows(attitude);
    std::array::from_fn(|i| rows.iter().zip(v).map(|(row, v)| row[i] * v).sum())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_nose_to_the_east_that_is_up_and_a_right_roll_have_their_signs() {
        let close = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12);
        let quarter = std::f64::consts::FRAC_PI_2;
        // Moving north is moving left.
        assert!(close(
            to_body([0.0, 0.0, quarter], [1.0, 0.0, 0.0]),
            [0.0, -1.0, 0.0]
        ));
        // With the nose up, up is forward; rolled right, the belly looks to the left.
        assert!(close(
            to_body([0.0, quarter, 0.0], [0.0, 0.0, -1.0]),
            [1.0, 0.0, 0.0]
        ));
        let belly = rows([0.3, 0.0, 0.0]).map(|row| row[2]);
        assert!(close(belly, [0.0, -0.3_f64.sin(), 0.3_f64.cos()]));
    }
}
