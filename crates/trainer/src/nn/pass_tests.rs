use random::Rng;

use super::*;

const SIZES: [usize; 4] = [6, 9, 5, 3];

fn batch(rng: &mut Rng, len: usize) -> Vec<f32> {
    (0..len).map(|_| rng.normal()).collect()
}

/// Loss `sum_i c_i y_i`: its gradient by the output is `c`.
fn loss(network: &Network, line: Option<Line<'_>>, input: &[f32], c: &[f32]) -> f64 {
    let mut pass = Pass::new(&SIZES, 8);
    pass.forward(network, line, input);
    pass.output(8).iter().zip(c).map(|(y, c)| f64::from(*y) * f64::from(*c)).sum()
}

fn check(line_of: impl Fn() -> Option<(Network, Vec<f32>)>) {
    let mut rng = Rng::new(11, 0);
    let mut network = Network::new(&SIZES, 1.0, &mut rng);
    let (input, c) = (batch(&mut rng, 8 * 6), batch(&mut rng, 8 * 3));
    let parent = line_of();
    let line = parent.as_ref().map(|(p, t)| Line { parent: p, blend: t });
    let mut gradient = vec![0.0; network.parameters.len()];
    let mut pass = Pass::new(&SIZES, 8);
    pass.forward(&network, line, &input);
    pass.output_and_delta(8).1.copy_from_slice(&c);
    pass.backward(&network, line, &input, &mut gradient, None);
    let mut bad = 0;
    for (i, found) in gradient.iter().enumerate() {
        let (kept, h) = (network.parameters[i], 1e-3);
        network.parameters[i] = kept + h;
        let up = loss(&network, line, &input, &c);
        network.parameters[i] = kept - h;
        let low = loss(&network, line, &input, &c);
        network.parameters[i] = kept;
        let difference = (up - low) / (2.0 * f64::from(h));
        // A kink of a ReLU inside the difference spoils single entries.
        bad += usize::from((difference - f64::from(*found)).abs() > 1e-2 * (1.0 + difference.abs()));
    }
    assert!(bad <= 2, "{bad} of {} entries", network.parameters.len());
}

#[test]
fn gradients_agree_with_finite_differences() {
    check(|| None);
}

#[test]
fn blended_gradients_agree_with_finite_differences() {
    check(|| {
        let mut rng = Rng::new(5, 0);
        Some((Network::new(&SIZES, 1.0, &mut rng), (0..8).map(|i| i as f32 / 7.0).collect()))
    });
}

#[test]
fn parent_and_child_change_places_with_their_gradients() {
    let mut rng = Rng::new(7, 0);
    let (a, b) = (Network::new(&SIZES, 1.0, &mut rng), Network::new(&SIZES, 1.0, &mut rng));
    let (input, c) = (batch(&mut rng, 8 * 6), batch(&mut rng, 8 * 3));
    let t: Vec<f32> = (0..8).map(|i| i as f32 / 7.0).collect();
    let rest: Vec<f32> = t.iter().map(|t| 1.0 - t).collect();
    let gradients = |child: &Network, parent: &Network, blend: &[f32]| {
        let line = Some(Line { parent, blend });
        let mut of_child = vec![0.0; child.parameters.len()];
        let mut of_parent = of_child.clone();
        let mut pass = Pass::new(&SIZES, 8);
        pass.forward(child, line, &input);
        pass.output_and_delta(8).1.copy_from_slice(&c);
        pass.backward(child, line, &input, &mut of_child, Some(&mut of_parent));
        (of_child, of_parent)
    };
    let (forth, back) = (gradients(&a, &b, &t), gradients(&b, &a, &rest));
    let worst = |x: &[f32], y: &[f32]| x.iter().zip(y).map(|(x, y)| (x - y).abs()).fold(0.0, f32::max);
    assert!(worst(&forth.0, &back.1) < 1e-5 && worst(&forth.1, &back.0) < 1e-5);
    assert!(forth.1.iter().any(|g| g.abs() > 0.1));
}

#[test]
fn a_blended_pass_is_the_interpolated_network() {
    let mut rng = Rng::new(2, 0);
    let (a, b) = (Network::new(&SIZES, 1.0, &mut rng), Network::new(&SIZES, 1.0, &mut rng));
    let input = batch(&mut rng, 8 * 6);
    let mut between = a.clone();
    let t = 0.3;
    for (m, c) in between.parameters.iter_mut().zip(&b.parameters) {
        *m = (1.0 - t) * *m + t * c;
    }
    let (mut x, mut y) = (Pass::new(&SIZES, 8), Pass::new(&SIZES, 8));
    x.forward(&b, Some(Line { parent: &a, blend: &[t; 8] }), &input);
    y.forward(&between, None, &input);
    let worst = x.output(8).iter().zip(y.output(8)).map(|(x, y)| (x - y).abs()).fold(0.0, f32::max);
    assert!(worst < 1e-5, "{worst}");
}

#[test]
fn fewer_rows_than_made_for_give_the_same_numbers() {
    let mut rng = Rng::new(3, 0);
    let network = Network::new(&SIZES, 1.0, &mut rng);
    let input = batch(&mut rng, 8 * 6);
    let mut pass = Pass::new(&SIZES, 8);
    pass.forward(&network, None, &input);
    let all = pass.output(8).to_vec();
    pass.forward(&network, None, &input[..2 * 6]);
    let worst = pass.output(2).iter().zip(&all).map(|(x, y)| (x - y).abs()).fold(0.0, f32::max);
    assert!(worst < 1e-6);
}
