//! How wrong a picture may be.

use crate::measure::metric::{METRICS, Metric, metric};
use std::fmt;

/// A bound on one metric: what it says must be at least `limit` where higher is better, at most `limit` elsewhere.
#[derive(Clone, Copy)]
pub struct Bound {
    /// The metric.
    pub metric: &'static Metric,
    /// The limit, in the metric's unit.
    pub limit: f64,
}

impl Bound {
    /// `METRIC=VALUE`.
    ///
    /// # Errors
    /// What is wrong with the text, in one line; for a metric that is unknown, the names of those that there are.
    pub fn parse(text: &str) -> Result<Self, String> {
        let (name, value) = text.split_once('=').ok_or("expected METRIC=VALUE, such as flip=0.01")?;
        let metric = metric(name).ok_or_else(|| {
            let names: Vec<&str> = METRICS.iter().map(|metric| metric.name).collect();
            format!("no metric is called {name}; there are {}", names.join(", "))
        })?;
        let limit = value.parse().ok().filter(|limit: &f64| !limit.is_nan());
        let limit = limit.ok_or_else(|| format!("{name}: expected a number, such as {name}=0.01"))?;
        Ok(Self { metric, limit })
    }

    /// Of several bounds on one metric only the strictest.
    pub fn strictest(bounds: impl IntoIterator<Item = Self>) -> Vec<Self> {
        let mut strictest: Vec<Self> = Vec::new();
        for bound in bounds {
            match strictest.iter_mut().find(|other| other.metric.name == bound.metric.name) {
                Some(other) if other.holds(bound.limit) => *other = bound,
                Some(_) => {}
                None => strictest.push(bound),
            }
        }
        strictest
    }

    /// No bound at all, but `metric` is measured.
    pub fn none(metric: &'static Metric) -> Self {
        let limit = if metric.is_higher_better() { f64::NEG_INFINITY } else { f64::INFINITY };
        Self { metric, limit }
    }

    /// Whether `score` keeps it. What has no score, NaN here, does not.
    pub fn holds(&self, score: f64) -> bool {
        if self.metric.is_higher_better() { score >= self.limit } else { score <= self.limit }
    }

    /// Whether equal pictures keep it; else nothing can.
    pub fn can_hold(&self) -> bool {
        self.holds(self.metric.best)
    }

    /// A score as an error, which is 0 for equal pictures and grows as they differ: psnr as the RMSE that it stands for.
    pub fn error(&self, score: f64) -> f64 {
        let best = self.metric.best;
        if best.is_infinite() { libm::pow(10.0, -score / 20.0) } else { (best - score).abs() }
    }
}

impl PartialEq for Bound {
    fn eq(&self, other: &Self) -> bool {
        self.metric.name == other.metric.name && self.limit == other.limit
    }
}

impl fmt::Debug for Bound {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Bound({self})")
    }
}

impl fmt::Display for Bound {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}={}", self.metric.name, self.limit)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bound(text: &str) -> Bound {
        Bound::parse(text).expect("right")
    }

    #[test]
    fn bounds_are_below_or_above_as_the_metric_has_it() {
        assert!(bound("flip=0.01").holds(0.01) && !bound("flip=0.01").holds(0.011));
        assert!(bound("psnr=40").holds(f64::INFINITY) && bound("psnr=40").holds(40.0) && !bound("psnr=40").holds(39.9));
        assert!(bound("ssim=0.99").holds(1.0) && !bound("ssim=0.99").holds(0.98));
        assert!(METRICS.iter().all(|metric| !bound(&format!("{}=1", metric.name)).holds(f64::NAN)));
        assert!(METRICS.iter().all(|metric| Bound::none(metric).holds(if metric.best > 0.0 { 0.1 } else { 9.0 })));
    }

    #[test]
    fn of_several_bounds_on_a_metric_the_strictest_counts() {
        let all = ["flip=0.1", "psnr=30", "flip=0.02", "psnr=40", "psnr=35", "flip=0.05"].map(bound);
        assert_eq!(Bound::strictest(all), [bound("flip=0.02"), bound("psnr=40")]);
    }

    #[test]
    fn what_cannot_be_kept_is_known() {
        assert!(["flip=0", "psnr=inf", "ssim=1"].iter().all(|text| bound(text).can_hold()));
        assert!(["flip=-1", "ssim=1.01", "pixels_off=-0.5"].iter().all(|text| !bound(text).can_hold()));
    }

    #[test]
    fn errors_grow_from_zero() {
        assert_eq!(bound("psnr=40").error(f64::INFINITY), 0.0);
        assert!((bound("psnr=40").error(40.0) - 0.01).abs() < 1e-12);
        assert_eq!((bound("ssim=1").error(1.0), bound("rmse=1").error(0.25)), (0.0, 0.25));
    }

    #[test]
    fn what_makes_no_sense_is_refused() {
        for bad in ["", "flip", "flip=", "flip=x", "flip=nan", "=1", "FLIP=1"] {
            assert!(Bound::parse(bad).is_err(), "{bad}");
        }
        let said = Bound::parse("speed=1").expect_err("unknown");
        assert!(METRICS.iter().all(|metric| said.contains(metric.name)), "{said}");
    }
}
