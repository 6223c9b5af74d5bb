use super::*;

/// Values of R and SciPy (`binomtest(k, n).proportion_ci(method="wilson")`), to rounding.
#[test]
fn wilson_gives_the_known_intervals() {
    let known = [
        (7, 10, 0.396_778_147_461_145_26, 0.892_208_732_593_699),
        (0, 5, 0.0, 0.434_482_464_783_174_76),
        (98, 100, 0.929_988_209_271_456_1, 0.994_498_032_449_837_7),
        (50, 100, 0.403_831_530_365_995_6, 0.596_168_469_634_004_4),
    ];
    for (k, n, low, high) in known {
        let found = wilson(k, n);
        assert!((found.0 - low).abs() < 1e-12 && (found.1 - high).abs() < 1e-12, "{k} of {n}: {found:?}");
    }
    assert_eq!(wilson(0, 0), (0.0, 1.0));
    assert_eq!((wilson(0, 7).0, wilson(7, 7).1), (0.0, 1.0));
}

/// Those of NumPy, whose default is type 7.
#[test]
fn quantiles_are_of_type_7() {
    let values = [1.0, 2.0, 4.0, 8.0, 16.0];
    for (q, expected) in [(0.0, 1.0), (0.1, 1.4), (0.25, 2.0), (0.5, 4.0), (0.6, 5.6), (0.9, 12.8), (1.0, 16.0)] {
        assert!((quantile(&values, q) - expected).abs() < 1e-12, "{q}");
    }
    assert_eq!(quantile(&[3.0], 0.7), 3.0);
    assert_eq!(quantile(&[1.0, f64::INFINITY, f64::INFINITY], 0.9), f64::INFINITY);
    assert!(quantile(&[], 0.5).is_nan());
    assert_eq!(median(&[5.0, 1.0, 3.0, 2.0]), 2.5);
}

/// Ranks from the binomial distribution (SciPy); 6 and 15 of 20, 40 and 61 of 100 stand in the textbooks.
#[test]
fn median_interval_takes_the_known_ranks() {
    for (n, rank) in [(6, 1), (9, 2), (10, 2), (20, 6), (25, 8), (51, 19), (100, 40), (2000, 956)] {
        let values: Vec<f64> = (1..=n).map(f64::from).collect();
        assert_eq!(median_interval(&values), Some((f64::from(rank), f64::from(n + 1 - rank))), "{n}");
    }
    // P(all five on one side) = 1/16 > 5 %
    assert_eq!(median_interval(&[1.0, 2.0, 3.0, 4.0, 5.0]), None);
    assert_eq!(median_interval(&[]), None);
}

#[test]
fn mean_and_deviation_are_those_of_a_sample() {
    assert_eq!(mean_sd(&[2.0, 4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 9.0]), (5.0, (32.0_f64 / 7.0).sqrt()));
    let (mean, sd) = mean_sd(&[3.0]);
    assert!(mean == 3.0 && sd.is_nan());
    assert!(mean_sd(&[]).0.is_nan());
}

/// Values of SciPy (`binomtest(min(b, c), b + c).pvalue`); the approximate ones in logarithms to 1e-12 of their size.
#[test]
fn mcnemar_gives_the_known_values() {
    let known = [
        (1, 9, 0.021_484_375),
        (10, 10, 1.0),
        (3, 40, 3.021_341_399_289_267_6e-9),
        (200, 260, 0.005_883_922_473_103_99),
        (0, 60, 2.0_f64.powi(-59)),
    ];
    for (b, c, p) in known {
        assert!((mcnemar_exact(b, c) / p - 1.0).abs() < 1e-11, "{b} {c}: {}", mcnemar_exact(b, c));
        assert_eq!(mcnemar_exact(b, c), mcnemar_exact(c, b));
    }
    assert_eq!(mcnemar_exact(0, 0), 1.0);
}

/// For a mean the percentile interval nears mean ± 1.96 s √((n − 1) / n) / √n.
#[test]
fn bootstrap_of_a_mean_nears_the_normal_interval() {
    let values: Vec<f64> = (0..200).map(|i| f64::from(i * 37 % 200)).collect();
    let (mean, sd) = mean_sd(&values);
    let n = values.len();
    let (low, high) = bootstrap(20_000, 1, n, |drawn| chosen(&values, drawn).iter().sum::<f64>() / n as f64);
    let half = Z * sd * ((n - 1) as f64).sqrt() / n as f64;
    // a 2.5 % quantile of 20 000 draws is uncertain by about 2 % of the half width
    assert!((low - (mean - half)).abs() < 0.05 * half, "{low} {}", mean - half);
    assert!((high - (mean + half)).abs() < 0.05 * half, "{high} {}", mean + half);
}

#[test]
fn bootstrap_depends_on_its_seed_alone() {
    let mean = |drawn: &[usize]| drawn.iter().sum::<usize>() as f64;
    assert_eq!(bootstrap(100, 5, 30, mean), bootstrap(100, 5, 30, mean));
    assert_ne!(bootstrap(100, 5, 30, mean), bootstrap(100, 6, 30, mean));
    assert!(bootstrap(100, 5, 0, |_| f64::NAN).0.is_nan());
}

#[test]
fn ratio_of_medians_covers_the_true_ratio() {
    let a: Vec<f64> = (0..101).map(|i| 20.0 + 0.1 * f64::from(i)).collect();
    let b: Vec<f64> = (0..101).map(|i| 10.0 + 0.05 * f64::from(i)).collect();
    let (low, high) = ratio_of_medians_interval(&a, &b, 3);
    assert!(1.8 < low && low < 2.0 && 2.0 < high && high < 2.2, "{low} {high}");
    assert_eq!(ratio_of_medians_interval(&[6.0; 9], &[3.0; 4], 3), (2.0, 2.0));
    assert!(ratio_of_medians_interval(&[], &[1.0], 3).0.is_nan());
}

/// Coefficients of `scipy.stats.linregress` and `numpy.polyfit(x, y, 2)`.
#[test]
fn regression_gives_the_known_coefficients() {
    let found = Regression::fit(&[1.0, 2.0, 4.0, 8.0, 16.0], &[3.0, 1.0, 4.0, 1.0, 5.0], 0).unwrap();
    assert_eq!(found.n, 5);
    assert!((found.slope.value - 0.149_193_548_387_096_75).abs() < 1e-12);
    assert!((found.intercept - 1.875).abs() < 1e-12);
    assert!((found.r2 - 0.258_757_560_483_870_83).abs() < 1e-12);
    assert!((found.curvature.unwrap().value - 0.032_574_320_050_600_895).abs() < 1e-12);
    assert!((found.at(10.0) - 3.366_935_483_870_967).abs() < 1e-12);
}

#[test]
fn a_parabola_is_told_from_a_line() {
    let x: Vec<f64> = (0..60).map(|i| 1000.0 + f64::from(i)).collect();
    let noise = |i: usize| ((i * 7919) % 13) as f64 - 6.0; // about zero
    let line: Vec<f64> = x.iter().enumerate().map(|(i, x)| 3.0 * x - 5.0 + noise(i)).collect();
    let bent: Vec<f64> = x.iter().zip(&line).map(|(x, y)| y + 0.02 * (x - 1000.0).powi(2)).collect();
    let straight = Regression::fit(&x, &line, 1).unwrap();
    assert!(!straight.slope.excludes(3.0) && straight.slope.excludes(2.5), "{straight:?}");
    assert!(!straight.curvature.unwrap().excludes(0.0), "{straight:?}");
    let curved = Regression::fit(&x, &bent, 1).unwrap().curvature.unwrap();
    assert!(curved.excludes(0.0) && !curved.excludes(0.02), "{curved:?}");
}

#[test]
fn regression_needs_different_points() {
    assert_eq!(Regression::fit(&[], &[], 0), None);
    assert_eq!(Regression::fit(&[2.0, 2.0], &[1.0, 3.0], 0), None);
    assert_eq!(Regression::fit(&[2.0, f64::NAN], &[1.0, 3.0], 0), None);
    let two = Regression::fit(&[1.0, 2.0, 2.0], &[1.0, 3.0, 3.0], 0).unwrap();
    assert_eq!((two.slope.value, two.curvature), (2.0, None));
    assert!((two.r2 - 1.0).abs() < 1e-15);
}
