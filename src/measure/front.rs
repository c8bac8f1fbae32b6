//! What is worth having: of points in time and error, those that no other beats in both.

/// Of `places`, in their order, those that no other of them `beats`.
pub fn unbeaten(places: &[usize], beats: impl Fn(usize, usize) -> bool) -> Vec<usize> {
    let is_beaten = |place: usize| places.iter().any(|&other| other != place && beats(other, place));
    places.iter().copied().filter(|&place| !is_beaten(place)).collect()
}

/// The places of the points, each a time and an error, that no other is as good as in both, the fastest first. Of equals
/// the first stays.
pub fn front(points: &[(f64, f64)]) -> Vec<usize> {
    let places: Vec<usize> = (0..points.len()).collect();
    let beats = |a: usize, b: usize| {
        let ((time, error), (other_time, other_error)) = (points[a], points[b]);
        time <= other_time && error <= other_error && (points[a] != points[b] || a < b)
    };
    let mut front = unbeaten(&places, beats);
    front.sort_by(|&a, &b| points[a].0.total_cmp(&points[b].0));
    front
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_front_goes_from_fast_to_true_and_has_one_of_equals() {
        let points = [(80.0, 0.0), (90.0, 0.001), (40.0, 0.04), (40.0, 0.04), (40.0, 0.05), (80.0, 0.0)];
        assert_eq!(front(&points), [2, 0]);
        assert!(front(&[]).is_empty());
    }
}
