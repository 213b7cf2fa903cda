use alloc::vec;

use super::*;

fn two_links() -> (Vec<SkeletonBody>, Vec<SkeletonJoint>) {
    let body = |name: &str, parent: Option<usize>| SkeletonBody {
        name: name.into(),
        parent: parent.map(BodyId::new),
    };
    let joint =
        SkeletonJoint { name: "hinge".into(), body: BodyId::new(1), axis: Vec3::Y, range: [-1.0, 1.0] };
    (vec![body("trunk", None), body("arm", Some(0))], vec![joint])
}

fn refused(
    change: impl FnOnce(&mut Vec<SkeletonBody>, &mut Vec<SkeletonJoint>, &mut Roles),
) -> SkeletonError {
    let ((mut bodies, mut joints), mut roles) = (two_links(), Roles::default());
    change(&mut bodies, &mut joints, &mut roles);
    Skeleton::from_parts(bodies, joints, roles).expect_err("the skeleton is bad")
}

#[test]
fn lengths_of_the_humanoid_are_those_of_the_paper() {
    let s = Skeleton::humanoid();
    assert_eq!((s.observation_len(), s.policy_input_len()), (223, 225));
    assert_eq!((s.frame_len(), s.discriminator_input_len()), (125, 625));
    let names = |ids: &[BodyId]| ids.iter().map(|id| s.body(*id).name.as_str()).collect::<Vec<_>>();
    assert_eq!(names(s.hands()), ["right_hand", "left_hand"]);
    assert_eq!(names(s.feet()), ["right_foot", "left_foot"]);
    assert_eq!(s.jointed_bodies().len(), 12);
    let knee = &s.joints()[s.joint_named("left_knee").unwrap().index()];
    assert_eq!(s.body(knee.body).name, "left_shin");
    assert_eq!(s.parent(knee.body), s.body_named("left_thigh"));
}

#[test]
fn lengths_of_another_skeleton_follow_its_parts() {
    let (bodies, joints) = two_links();
    let s = Skeleton::from_parts(bodies, joints, Roles::default()).unwrap();
    assert_eq!((s.observation_len(), s.policy_input_len(), s.frame_len()), (28, 30, 20));
}

#[test]
fn bad_skeletons_are_refused() {
    assert!(matches!(refused(|b, _, _| b.clear()), SkeletonError::Count { what: "bodies", found: 0 }));
    assert!(matches!(refused(|_, j, _| j.clear()), SkeletonError::Count { what: "joints", found: 0 }));
    assert!(matches!(
        refused(|b, _, _| b[1].name = "trunk".into()),
        SkeletonError::Name { what: "body", .. }
    ));
    assert!(matches!(refused(|b, _, _| b[1].parent = None), SkeletonError::Parent { .. }));
    assert!(matches!(refused(|b, _, _| b[1].parent = Some(BodyId::new(1))), SkeletonError::Parent { .. }));
    assert!(matches!(refused(|b, _, _| b[0].parent = Some(BodyId::new(0))), SkeletonError::Parent { .. }));
    assert!(matches!(refused(|_, j, _| j[0].body = BodyId::new(2)), SkeletonError::Body { found: 2, .. }));
    assert!(matches!(refused(|_, j, _| j[0].axis = Vec3::ZERO), SkeletonError::Joint { .. }));
    assert!(matches!(refused(|_, j, _| j[0].axis = Vec3::splat(1e30)), SkeletonError::Joint { .. }));
    assert!(matches!(refused(|_, j, _| j[0].range = [1.0, 1.0]), SkeletonError::Joint { .. }));
    assert!(matches!(refused(|_, j, _| j[0].range[0] = f32::NAN), SkeletonError::Joint { .. }));
    assert!(matches!(refused(|_, _, r| r.feet.push(BodyId::new(9))), SkeletonError::Body { found: 9, .. }));
}
