//! From the bytes of a `.glb` to a [`SkinnedMesh`].

use glam::{Affine3A, Mat4};
use gltf::accessor::{DataType, Dimensions};
use policy_core::BodyId;

use super::binding::Binding;
use super::primitive::{Follow, Primitive};
use super::read::{Checked, is_kind};
use super::{Joint, Level, MAX_JOINTS, Material, MeshError, Part, Rig, SkinnedMesh, parse};

pub(super) fn load(bytes: &[u8], rig: &Rig) -> Result<SkinnedMesh, MeshError> {
    let glb = parse::parse(bytes)?;
    let blob = glb.blob.as_deref().ok_or(MeshError::NoBinary)?;
    let checked = Checked::new(&glb.document, blob)?;
    let document = checked.document;
    let skinned = document.nodes().find_map(|n| Some((n.mesh()?, n.skin()?)));
    let is_body = |name: &str| rig.skeleton().body_named(name).is_some();
    let rigid = || document.nodes().any(|n| n.mesh().is_some() && n.name().is_some_and(is_body));
    if skinned.is_none() && !rigid() {
        return Err(MeshError::NoSkin { meshes: document.meshes().count() });
    }
    let binding = Binding::of(document, rig)?;
    let mut materials: Vec<Material> = document.materials().map(|m| material(&m)).collect();
    materials.push(material_of([0.6, 0.6, 0.6], 0.6, 0.0, true));
    let (joints, levels) = match skinned {
        Some((mesh, skin)) => {
            (skin_joints(&checked, &skin, &binding)?, skinned_levels(&checked, &mesh, &skin)?)
        }
        None => rigid_level(&checked, &binding)?,
    };
    Ok(SkinnedMesh { joints, materials, levels })
}

fn material(material: &gltf::Material<'_>) -> Material {
    let pbr = material.pbr_metallic_roughness();
    let [r, g, b, _] = pbr.base_color_factor();
    // Dark parts keep their colour, so that a tint reads as a change of clothes.
    material_of([r, g, b], pbr.roughness_factor(), pbr.metallic_factor(), r.max(g).max(b) > 0.2)
}

fn material_of(colour: [f32; 3], roughness: f32, metallic: f32, tinted: bool) -> Material {
    Material { colour, roughness: roughness.clamp(0.05, 1.0), metallic: metallic.clamp(0.0, 1.0), tinted }
}

fn skin_joints(
    checked: &Checked<'_>,
    skin: &gltf::Skin<'_>,
    binding: &Binding,
) -> Result<Vec<Joint>, MeshError> {
    let count = skin.joints().count();
    if count > MAX_JOINTS {
        return Err(MeshError::TooMany { what: "joints", most: MAX_JOINTS, found: count });
    }
    if let Some(accessor) = skin.inverse_bind_matrices()
        && (!is_kind(&accessor, Dimensions::Mat4, &[DataType::F32]) || accessor.count() < count)
    {
        return Err(MeshError::Unsupported {
            what: "inverseBindMatrices that are not one f32 4x4 a joint".into(),
        });
    }
    let inverse_bind: Vec<Mat4> = skin.reader(checked.data()).read_inverse_bind_matrices().map_or_else(
        || vec![Mat4::IDENTITY; count],
        |matrices| matrices.map(|m| Mat4::from_cols_array_2d(&m)).collect(),
    );
    skin.joints()
        .zip(inverse_bind)
        .map(|(node, inverse_bind)| {
            // The binding has an entry for every node, and the gltf crate has checked the joints of skins.
            let world_from_mesh = binding.world_from_node[node.index()] * inverse_bind;
            joint(binding, binding.body_of_node[node.index()], world_from_mesh)
        })
        .collect()
}

fn joint(binding: &Binding, body: BodyId, world_from_mesh: Mat4) -> Result<Joint, MeshError> {
    let body_from_mesh = binding.body_from_world[body.index()] * Affine3A::from_mat4(world_from_mesh);
    if body_from_mesh.is_finite() {
        Ok(Joint { body, body_from_mesh })
    } else {
        Err(MeshError::Unsupported {
            what: format!("a transform of body {} with numbers that are not finite", body.index()),
        })
    }
}

/// The mesh itself, then meshes called `<name>_lod1`, `<name>_lod2`, ... that the same skin bends.
fn skinned_levels(
    checked: &Checked<'_>,
    mesh: &gltf::Mesh<'_>,
    skin: &gltf::Skin<'_>,
) -> Result<Vec<Level>, MeshError> {
    let joints = skin.joints().count();
    let mut levels = vec![level(checked, mesh, Follow::Skin { joints })?];
    if let Some(name) = mesh.name() {
        for number in 1.. {
            let wanted = format!("{name}_lod{number}");
            let Some(coarse) = checked.document.meshes().find(|m| m.name() == Some(&wanted)) else { break };
            levels.push(level(checked, &coarse, Follow::Skin { joints })?);
        }
    }
    Ok(levels)
}

/// Meshes that hang on body nodes, each moving as one.
fn rigid_level(checked: &Checked<'_>, binding: &Binding) -> Result<(Vec<Joint>, Vec<Level>), MeshError> {
    let mut joints = Vec::new();
    let mut whole = Level::default();
    for node in checked.document.nodes() {
        let Some(mesh) = node.mesh() else { continue };
        if joints.len() == MAX_JOINTS {
            return Err(MeshError::TooMany { what: "meshes", most: MAX_JOINTS, found: MAX_JOINTS + 1 });
        }
        let follow = Follow::One { joint: joints.len() as u8 };
        append(&mut whole, level(checked, &mesh, follow)?);
        // The binding has an entry for every node and for every body.
        let body = binding.body_of_node[node.index()];
        joints.push(joint(binding, body, binding.world_from_node[node.index()])?);
    }
    Ok((joints, vec![whole]))
}

fn append(whole: &mut Level, level: Level) {
    let (vertices, indices) = (whole.vertices.len() as u32, whole.indices.len() as u32);
    whole.vertices.extend(level.vertices);
    whole.indices.extend(level.indices.iter().map(|i| i + vertices));
    whole.parts.extend(
        level.parts.into_iter().map(|p| Part {
            material: p.material,
            indices: p.indices.start + indices..p.indices.end + indices,
        }),
    );
}

fn level(checked: &Checked<'_>, mesh: &gltf::Mesh<'_>, follow: Follow) -> Result<Level, MeshError> {
    let mut whole = Level::default();
    for primitive in mesh.primitives() {
        let one = Primitive { checked, mesh, primitive: &primitive }.read(follow)?;
        append(&mut whole, one);
    }
    Ok(whole)
}
