//! The mirror image of a policy: a network of the same size that does to the left what the policy does to the right.
//!
//! In the mirror y changes its sign, and a body on the left is its twin on the right. So each input of the image is one input of the policy,
//! up to its sign, and so is each output. The hidden layer stays as it is; only the order and the signs of the numbers on both sides of it
//! change, so the image is exact, but for inputs that are clipped. It is of no family with the policy: half-way between both lies no good policy.

use clips::twin_name;
use policy_core::training::{ActionScaling, Normaliser, TARGET_LEN};
use policy_core::{BodyId, Skeleton};

use crate::nn::Network;

/// Signs of the coordinates of a polar vector in the mirror: a position, a velocity, an axis of a body.
const POLAR: [f32; 3] = [1.0, -1.0, 1.0];

/// Signs of those of an axial vector: an angular velocity, the axis of a hinge.
const AXIAL: [f32; 3] = [-1.0, 1.0, -1.0];

/// Two axes are parallel whose cosine is at least this.
const PARALLEL: f32 = 0.999;

/// Which number of the original a number of the image is, and with which sign.
type Image = Vec<(usize, f32)>;

/// The mirror image of a policy of this body.
///
/// # Errors
/// In words, where a skeleton has no mirror image: a joint without a twin.
///
/// # Panics
/// When the network does not fit the skeleton.
pub fn mirrored(
    policy: &Network,
    skeleton: &Skeleton,
    observation: &Normaliser,
    scaling: &ActionScaling,
) -> Result<Network, String> {
    let (inputs, outputs) = (image_of_inputs(skeleton), image_of_joints(skeleton)?);
    assert_eq!(
        [policy.inputs(), policy.outputs()],
        [inputs.len(), outputs.len()],
        "a policy of the skeleton"
    );
    let layers = policy.layers();
    // A network has at least one layer.
    let (first, last) = (&layers[0], &layers[layers.len() - 1]);
    let mut image = policy.clone();
    // Observations are normalised, targets are not.
    let number = |values: &[f32], i: usize, otherwise: f32| values.get(i).copied().unwrap_or(otherwise);
    let mean = |i| number(observation.mean(), i, 0.0);
    let deviation = |i| number(observation.deviation(), i, 1.0);
    for (i, &(of, sign)) in inputs.iter().enumerate() {
        let factor = sign * deviation(of) / deviation(i);
        let shift = (sign * mean(of) - mean(i)) / deviation(i);
        for out in 0..first.outputs {
            let weight = policy.parameters[first.weight.start + i * first.outputs + out];
            image.parameters[first.weight.start + of * first.outputs + out] = factor * weight;
            image.parameters[first.bias.start + out] += shift * weight;
        }
    }
    let before = image.parameters.clone();
    let (centre, gain) = (scaling.centre(), scaling.gain());
    for (joint, &(of, sign)) in outputs.iter().enumerate() {
        let factor = sign * gain[of] / gain[joint];
        for i in 0..last.inputs {
            let row = last.weight.start + i * last.outputs;
            image.parameters[row + joint] = factor * before[row + of];
        }
        let shift = (sign * centre[of] - centre[joint]) / gain[joint];
        image.parameters[last.bias.start + joint] = factor * before[last.bias.start + of] + shift;
    }
    Ok(image)
}

/// The image of an observation and a target; the order is that of [`policy_core::observe_into`].
fn image_of_inputs(skeleton: &Skeleton) -> Image {
    let twins: Vec<usize> = (0..skeleton.body_count()).map(|body| twin(skeleton, body)).collect();
    let mut image = vec![(0, 1.0)];
    let mut vectors = |twins: &[usize], signs: &[f32]| {
        let at = image.len();
        let place = |(body, i): (&usize, usize)| (at + body * signs.len() + i, signs[i]);
        image.extend(twins.iter().flat_map(|body| (0..signs.len()).map(move |i| place((body, i)))));
    };
    // Of places the root has none.
    let others: Vec<usize> = twins.iter().skip(1).map(|body| body - 1).collect();
    vectors(&others, &POLAR);
    vectors(&twins, &[POLAR, POLAR].concat());
    vectors(&twins, &POLAR);
    vectors(&twins, &AXIAL);
    let at = image.len();
    image.extend((0..TARGET_LEN).map(|i| (at + i, POLAR[i])));
    image
}

/// The image of the joints: those of a twin in the same order.
fn image_of_joints(skeleton: &Skeleton) -> Result<Image, String> {
    let joints = skeleton.joints();
    let of_body = |body: BodyId| joints.iter().enumerate().filter(move |(_, joint)| joint.body == body);
    let place = |index: usize| of_body(joints[index].body).take_while(|(other, _)| *other != index).count();
    let image = |index: usize| {
        let joint = &joints[index];
        let twin = of_body(BodyId::new(twin(skeleton, joint.body.index()))).nth(place(index));
        let [x, y, z] = AXIAL;
        let axis = joint.axis.normalize() * glam::Vec3::new(x, y, z);
        twin.map(|(of, twin)| (of, axis.dot(twin.axis.normalize())))
            .filter(|(_, cosine)| cosine.abs() > PARALLEL)
            .map(|(of, cosine)| (of, cosine.signum()))
            .ok_or(format!("expected a joint on the other side like {:?}, found none", joint.name))
    };
    (0..joints.len()).map(image).collect()
}

/// The body on the other side; itself for one in the middle, or without a twin.
fn twin(skeleton: &Skeleton, body: usize) -> usize {
    let twin = twin_name(&skeleton.bodies()[body].name).and_then(|name| skeleton.body_named(&name));
    twin.map_or(body, BodyId::index)
}

#[cfg(test)]
mod tests {
    use glam::{Quat, Vec2, Vec3};
    use policy_core::{CharacterState, observe_into, target_input};
    use random::Rng;

    use super::*;

    /// Some pose in motion, heading along x, and the same in the mirror.
    fn pair(skeleton: &Skeleton, rng: &mut Rng) -> [CharacterState; 2] {
        let mut both = [CharacterState::new(skeleton), CharacterState::new(skeleton)];
        let mut number = || rng.normal();
        for body in 0..skeleton.body_count() {
            let mut vector = || Vec3::new(number(), number(), number());
            let (position, velocity, turns) = (vector(), vector(), vector());
            let angle = if body == 0 { Vec3::new(0.0, 0.3, 0.0) } else { vector() };
            let rotation = Quat::from_scaled_axis(angle);
            let flip = |v: Vec3, [x, y, z]: [f32; 3]| v * Vec3::new(x, y, z);
            for (state, body, is_image) in
                [(0, body, false), (1, twin(skeleton, body), true)].map(|(i, b, m)| (i, BodyId::new(b), m))
            {
                let of = |v: Vec3, signs: [f32; 3]| if is_image { flip(v, signs) } else { v };
                let own = both[state].body_mut(body);
                own.position = of(position, POLAR);
                own.linear_velocity = of(velocity, POLAR);
                own.angular_velocity = of(turns, AXIAL);
                own.rotation = match is_image {
                    true => Quat::from_xyzw(-rotation.x, rotation.y, -rotation.z, rotation.w),
                    false => rotation,
                };
            }
        }
        both
    }

    #[test]
    fn the_image_does_in_the_mirror_what_the_policy_does() {
        let skeleton = Skeleton::humanoid();
        let mut rng = Rng::new(7, 0);
        let (inputs, joints) = (skeleton.policy_input_len(), skeleton.joint_count());
        let policy = Network::new(&[inputs, 24, 12, joints], 1.0, &mut rng);
        let mut numbers =
            |count: usize, least: f32| -> Vec<f32> { (0..count).map(|_| least + rng.uniform()).collect() };
        let len = skeleton.observation_len();
        let normaliser =
            Normaliser::from_mean_and_deviation(&numbers(len, -0.5), &numbers(len, 2.0)).unwrap();
        let scaling =
            ActionScaling::from_centre_and_gain(&numbers(joints, -0.5), &numbers(joints, 0.5)).unwrap();
        let image = mirrored(&policy, &skeleton, &normaliser, &scaling).unwrap();
        let targets = |network: &Network, state: &CharacterState, target: Vec2| -> Vec<f32> {
            let mut input = vec![0.0; inputs];
            observe_into(&skeleton, state, &mut input[..len]);
            normaliser.normalise_in_place(&mut input[..len]);
            input[len..].copy_from_slice(&target_input(state, target));
            let action = forward(network, &input);
            let numbers = action.iter().zip(scaling.centre()).zip(scaling.gain());
            numbers.map(|((a, centre), gain)| centre + gain * a).collect()
        };
        let [state, other] = pair(&skeleton, &mut rng);
        let (here, there) = (Vec2::new(2.0, 1.5), Vec2::new(2.0, -1.5));
        let expected = targets(&policy, &state, state.root().position.truncate() + here);
        let found = targets(&image, &other, other.root().position.truncate() + there);
        for (joint, &(of, sign)) in image_of_joints(&skeleton).unwrap().iter().enumerate() {
            let name = &skeleton.joints()[joint].name;
            assert!((found[joint] - sign * expected[of]).abs() < 1e-3, "{name}: {found:?} {expected:?}");
        }
        let twice = mirrored(&image, &skeleton, &normaliser, &scaling).unwrap();
        let off = twice.squared_distance(&policy);
        assert!(off < 1e-6 && image.squared_distance(&policy) > 1.0, "the mirror of the mirror: {off}");
    }

    #[test]
    fn a_body_without_a_twin_has_no_image() {
        let humanoid = Skeleton::humanoid();
        let mut joints = humanoid.joints().to_vec();
        joints.retain(|joint| joint.name != "left_knee");
        let lame =
            Skeleton::from_parts(humanoid.bodies().to_vec(), joints, humanoid.roles().clone()).unwrap();
        let error = image_of_joints(&lame).unwrap_err();
        assert_eq!(error, "expected a joint on the other side like \"right_knee\", found none");
    }

    /// ReLU between layers, none after the last.
    fn forward(network: &Network, input: &[f32]) -> Vec<f32> {
        let layers = network.layers();
        let mut values = input.to_vec();
        for (index, layer) in layers.iter().enumerate() {
            let mut next = network.parameters[layer.bias.clone()].to_vec();
            for (i, value) in values.iter().enumerate() {
                let row = layer.weight.start + i * layer.outputs;
                for (out, weight) in next.iter_mut().zip(&network.parameters[row..]) {
                    *out += value * weight;
                }
            }
            if index + 1 < layers.len() {
                next.iter_mut().for_each(|value| *value = value.max(0.0));
            }
            values = next;
        }
        values
    }
}
