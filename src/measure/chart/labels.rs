//! Labels in a column that keep clear of each other.

/// Height of a line.
const HEIGHT: f64 = 15.0;

/// Heights for labels that would like to stand at `wanted`, at least a line apart, between `top` and `bottom`, in order.
pub fn spread_out(wanted: &[f64], top: f64, bottom: f64) -> Vec<f64> {
    let mut order: Vec<usize> = (0..wanted.len()).collect();
    order.sort_by(|&a, &b| wanted[a].total_cmp(&wanted[b]));
    let mut heights = vec![0.0; wanted.len()];
    let mut next = top;
    for &i in &order {
        heights[i] = wanted[i].max(next);
        next = heights[i] + HEIGHT;
    }
    // What was pushed out below moves up again.
    let mut last = bottom;
    for &i in order.iter().rev() {
        heights[i] = heights[i].min(last);
        last = heights[i] - HEIGHT;
    }
    heights
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heights_are_a_line_apart() {
        let heights = spread_out(&[100.0, 100.0, 101.0, 20.0], 0.0, 110.0);
        let mut sorted = heights.clone();
        sorted.sort_by(f64::total_cmp);
        assert!(sorted.windows(2).all(|pair| pair[1] - pair[0] >= HEIGHT - 1e-9), "{heights:?}");
        assert!(sorted[3] <= 110.0);
    }
}
