use random::Rng;

use super::*;

const SIZES: [usize; 4] = [7, 10, 6, 1];
const ROWS: usize = 12;

fn output(network: &Network, input: &[f32]) -> f64 {
    let mut pass = Pass::new(&SIZES, 1);
    pass.forward(network, None, input);
    f64::from(pass.output(1)[0])
}

/// The loss from its definition: gradients by the input from differences of the network's output.
fn loss(network: &Network, input: &[f32], penalty: f64) -> f64 {
    let mut total = 0.0;
    for (i, row) in input.chunks_exact(7).enumerate() {
        let d = output(network, row);
        let real = i < ROWS / 2;
        total += if real { (-d).exp().ln_1p() } else { d.exp().ln_1p() };
        for k in 0..if real { 7 } else { 0 } {
            let mut moved = row.to_vec();
            moved[k] += 1e-3;
            let up = output(network, &moved);
            moved[k] -= 2e-3;
            total += penalty * ((up - output(network, &moved)) / 2e-3).powi(2);
        }
    }
    total
}

#[test]
fn loss_and_gradient_agree_with_finite_differences() {
    let mut rng = Rng::new(21, 0);
    let mut network = Network::new(&SIZES, 1.0, &mut rng);
    let input: Vec<f32> = (0..ROWS * 7).map(|_| rng.normal()).collect();
    let mut gradient = vec![0.0; network.parameters.len()];
    let mut pass = DiscriminatorPass::new(&SIZES, ROWS / 2);
    let sums = pass.accumulate(&network, &input, 0.7, 1.0, &mut gradient);
    let expected = loss(&network, &input, 0.7);
    let found = sums.cross_entropy + 0.7 * sums.squared_gradient;
    assert!((expected - found).abs() < 0.02 * expected, "{expected} {found}");
    let mut bad = 0;
    for (i, found) in gradient.iter().enumerate() {
        let (kept, h) = (network.parameters[i], 2e-3);
        network.parameters[i] = kept + h;
        let up = loss(&network, &input, 0.7);
        network.parameters[i] = kept - h;
        let low = loss(&network, &input, 0.7);
        network.parameters[i] = kept;
        let difference = (up - low) / (2.0 * f64::from(h));
        bad += usize::from((difference - f64::from(*found)).abs() > 0.05 * (1.0 + difference.abs()));
    }
    // Kinks inside a difference spoil single entries; a wrong term would spoil most.
    assert!(bad * 20 <= network.parameters.len(), "{bad} of {} entries", network.parameters.len());
}

#[test]
fn the_penalty_of_a_linear_discriminator_has_a_closed_form() {
    // One hidden unit that is always on: D = a (w x + b), squared gradient (a w)^2, its derivative by a is 2 a w^2.
    let mut network = Network::zeros(&[1, 1, 1]);
    network.parameters.copy_from_slice(&[0.5, 10.0, 3.0, 0.0]);
    let mut gradient = vec![0.0; 4];
    let mut pass = DiscriminatorPass::new(&[1, 1, 1], 1);
    let (with, without) = (&mut gradient, &mut vec![0.0; 4]);
    let sums = pass.accumulate(&network, &[0.1, 0.2], 1.0, 1.0, with);
    pass.accumulate(&network, &[0.1, 0.2], 0.0, 1.0, without);
    assert!((sums.squared_gradient - 2.25).abs() < 1e-6);
    let penalty: Vec<f32> = with.iter().zip(without.iter()).map(|(a, b)| a - b).collect();
    assert!(
        (penalty[0] - 2.0 * 9.0 * 0.5).abs() < 1e-4 && (penalty[2] - 2.0 * 3.0 * 0.25).abs() < 1e-4,
        "{penalty:?}"
    );
    assert_eq!((penalty[1], penalty[3]), (0.0, 0.0));
}

#[test]
fn sigmoid_and_softplus_hold_at_the_ends() {
    assert_eq!((sigmoid(200.0), sigmoid(-200.0)), (1.0, 0.0));
    assert_eq!((softplus(200.0), softplus(-200.0)), (200.0, 0.0));
    assert!((softplus(0.0) - core::f32::consts::LN_2).abs() < 1e-6);
}
