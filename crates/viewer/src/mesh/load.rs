//! From the bytes of a `.glb` to a [`SkinnedMesh`].

use glam::{Affine3A, Mat4};
use gltf::accessor::{DataType, Dimensions};
use gltf::mesh::Mode;
use policy_core::Body;

use super::binding::Binding;
use super::read::{Checked, is_kind};
use super::{Joint, Level, MAX_JOINTS, MAX_VERTICES, Material, MeshError, MeshVertex, Part, SkinnedMesh};

pub(super) fn load(bytes: &[u8]) -> Result<SkinnedMesh, MeshError> {
    let glb = gltf::Gltf::from_slice(bytes).map_err(MeshError::Parse)?;
    let blob = glb.blob.as_deref().ok_or(MeshError::NoBinary)?;
    let checked = Checked::new(&glb.document, blob)?;
    let document = checked.document;
    let skinned = document.nodes().find_map(|n| Some((n.mesh()?, n.skin()?)));
    let rigid =
        || document.nodes().any(|n| n.mesh().is_some() && n.name().and_then(Body::from_name).is_some());
    if skinned.is_none() && !rigid() {
        return Err(MeshError::NoSkin { meshes: document.meshes().count() });
    }
    let binding = Binding::of(document)?;
    let mut materials: Vec<Material> = document.materials().map(|m| material(&m)).collect();
    materials.push(material_of([0.6, 0.6, 0.6], 0.6, 0.0, true));
    let (joints, levels) = match skinned {
        Some((mesh, skin)) => {
            (skin_joints(&checked, &skin, &binding)?, skinned_levels(&checked, &mesh, &skin)?)
        }
        None => rigid_level(&checked, &binding)?,
    };
    let vertices: usize = levels.iter().map(|l| l.vertices.len()).sum();
    if vertices > MAX_VERTICES {
        return Err(MeshError::TooMany { what: "vertices", most: MAX_VERTICES, found: vertices });
    }
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
    Ok(skin
        .joints()
        .zip(inverse_bind)
        .map(|(node, inverse_bind)| {
            let world_from_mesh = binding.world_from_node[node.index()] * inverse_bind;
            joint(binding, binding.body_of_node[node.index()], world_from_mesh)
        })
        .collect())
}

fn joint(binding: &Binding, body: Body, world_from_mesh: Mat4) -> Joint {
    let body_from_mesh = binding.body_from_world[body.index()] * Affine3A::from_mat4(world_from_mesh);
    Joint { body, body_from_mesh }
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
        let body = binding.body_of_node[node.index()];
        joints.push(joint(binding, body, binding.world_from_node[node.index()]));
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

#[derive(Clone, Copy)]
enum Follow {
    Skin { joints: usize },
    One { joint: u8 },
}

fn level(checked: &Checked<'_>, mesh: &gltf::Mesh<'_>, follow: Follow) -> Result<Level, MeshError> {
    let mut whole = Level::default();
    for primitive in mesh.primitives() {
        let one = Primitive { checked, mesh, primitive: &primitive }.read(follow)?;
        append(&mut whole, one);
    }
    Ok(whole)
}

struct Primitive<'a, 'b> {
    checked: &'b Checked<'a>,
    mesh: &'b gltf::Mesh<'a>,
    primitive: &'b gltf::Primitive<'a>,
}

impl Primitive<'_, '_> {
    fn read(&self, follow: Follow) -> Result<Level, MeshError> {
        let float3 = (Dimensions::Vec3, &[DataType::F32][..]);
        if self.primitive.mode() != Mode::Triangles {
            return Err(self.inconsistent("triangles", format!("{:?}", self.primitive.mode())));
        }
        let count = self.attribute(&gltf::Semantic::Positions, "POSITION", float3)?;
        if count > MAX_VERTICES {
            return Err(MeshError::TooMany { what: "vertices", most: MAX_VERTICES, found: count });
        }
        self.same_count(&gltf::Semantic::Normals, "NORMAL", float3, count)?;
        let reader = self.primitive.reader(self.checked.data());
        let positions: Vec<[f32; 3]> = reader.read_positions().into_iter().flatten().collect();
        let normals: Vec<[f32; 3]> = reader.read_normals().into_iter().flatten().collect();
        if let Some(bad) = positions.iter().chain(&normals).flatten().find(|v| !v.is_finite()) {
            return Err(self.inconsistent("finite positions and normals", bad.to_string()));
        }
        let (joints, shares) = self.follow(follow, count)?;
        let colours = self.colours(count)?;
        let vertices = (0..count)
            .map(|i| MeshVertex {
                position: positions[i],
                normal: normals[i],
                colour: colours[i],
                joints: joints[i],
                follow: shares[i],
            })
            .collect();
        let indices = self.indices(count)?;
        let materials = self.checked.document.materials().count();
        let material = self.primitive.material().index().unwrap_or(materials);
        let parts = vec![Part { material, indices: 0..indices.len() as u32 }];
        Ok(Level { vertices, indices, parts })
    }

    fn indices(&self, count: usize) -> Result<Vec<u32>, MeshError> {
        let Some(accessor) = self.primitive.indices() else { return Ok((0..count as u32 / 3 * 3).collect()) };
        let types = [DataType::U8, DataType::U16, DataType::U32];
        if !is_kind(&accessor, Dimensions::Scalar, &types) || accessor.count() % 3 != 0 {
            return Err(
                self.inconsistent("whole triangles of unsigned indices", format!("{}", accessor.count()))
            );
        }
        if accessor.count() > 6 * MAX_VERTICES {
            return Err(MeshError::TooMany {
                what: "indices",
                most: 6 * MAX_VERTICES,
                found: accessor.count(),
            });
        }
        let reader = self.primitive.reader(self.checked.data());
        let indices: Vec<u32> = reader.read_indices().map(|i| i.into_u32().collect()).unwrap_or_default();
        match indices.iter().find(|&&i| i as usize >= count) {
            Some(index) => Err(self.inconsistent(&format!("indices below {count}"), index.to_string())),
            None => Ok(indices),
        }
    }

    fn follow(&self, follow: Follow, count: usize) -> Result<(Vec<[u8; 4]>, Vec<[u8; 4]>), MeshError> {
        let joints = match follow {
            Follow::One { joint } => return Ok((vec![[joint, 0, 0, 0]; count], vec![[255, 0, 0, 0]; count])),
            Follow::Skin { joints } => joints,
        };
        let unsigned = (Dimensions::Vec4, &[DataType::U8, DataType::U16][..]);
        let weights = (Dimensions::Vec4, &[DataType::F32, DataType::U8, DataType::U16][..]);
        self.same_count(&gltf::Semantic::Joints(0), "JOINTS_0", unsigned, count)?;
        self.same_count(&gltf::Semantic::Weights(0), "WEIGHTS_0", weights, count)?;
        let reader = self.primitive.reader(self.checked.data());
        let bodies: Vec<[u16; 4]> = reader.read_joints(0).map(|j| j.into_u16().collect()).unwrap_or_default();
        if let Some(joint) = bodies.iter().flatten().find(|&&j| usize::from(j) >= joints) {
            return Err(self.inconsistent(&format!("joints below {joints}"), joint.to_string()));
        }
        let shares: Vec<[f32; 4]> =
            reader.read_weights(0).map(|w| w.into_f32().collect()).unwrap_or_default();
        let shares: Option<Vec<[u8; 4]>> = shares.iter().map(bytes_of_shares).collect();
        let shares = shares.ok_or_else(|| self.inconsistent("weights that sum to 1", "none".into()))?;
        Ok((bodies.iter().map(|b| b.map(|j| j as u8)).collect(), shares))
    }

    fn colours(&self, count: usize) -> Result<Vec<[u8; 4]>, MeshError> {
        let reader = self.primitive.reader(self.checked.data());
        match self.primitive.get(&gltf::Semantic::Colors(0)) {
            None => Ok(vec![[255; 4]; count]),
            Some(accessor) if accessor.count() != count => {
                Err(self.inconsistent(&format!("{count} colours"), accessor.count().to_string()))
            }
            Some(_) => Ok(reader.read_colors(0).map(|c| c.into_rgba_u8().collect()).unwrap_or_default()),
        }
    }

    /// Number of elements of an attribute that must be there.
    fn attribute(
        &self,
        semantic: &gltf::Semantic,
        attribute: &'static str,
        (dimensions, types): (Dimensions, &[DataType]),
    ) -> Result<usize, MeshError> {
        let primitive = self.primitive.index();
        let accessor = self.primitive.get(semantic).ok_or_else(|| MeshError::MissingAttribute {
            mesh: self.mesh_name(),
            primitive,
            attribute,
        })?;
        if is_kind(&accessor, dimensions, types) {
            Ok(accessor.count())
        } else {
            let found = format!("{:?} of {:?}", accessor.dimensions(), accessor.data_type());
            Err(self.inconsistent(&format!("{attribute} as {dimensions:?} of {types:?}"), found))
        }
    }

    fn same_count(
        &self,
        semantic: &gltf::Semantic,
        attribute: &'static str,
        kind: (Dimensions, &[DataType]),
        count: usize,
    ) -> Result<(), MeshError> {
        match self.attribute(semantic, attribute, kind)? {
            found if found == count => Ok(()),
            found => Err(self.inconsistent(&format!("{count} elements in {attribute}"), found.to_string())),
        }
    }

    fn inconsistent(&self, expected: &str, found: String) -> MeshError {
        let primitive = self.primitive.index();
        MeshError::Inconsistent { mesh: self.mesh_name(), primitive, expected: expected.to_owned(), found }
    }

    fn mesh_name(&self) -> String {
        self.mesh.name().map_or_else(|| self.mesh.index().to_string(), str::to_owned)
    }
}

/// Shares as bytes that sum to 255; `None` when they are negative, not finite or all zero.
fn bytes_of_shares(shares: &[f32; 4]) -> Option<[u8; 4]> {
    let total: f32 = shares.iter().sum();
    if !total.is_finite() || total < 1e-4 || shares.iter().any(|s| *s < 0.0) {
        return None;
    }
    let mut bytes = shares.map(|s| (s / total * 255.0) as u8);
    let sum: u32 = bytes.iter().map(|&b| u32::from(b)).sum();
    let largest = (0..4).fold(0, |best, i| if bytes[i] > bytes[best] { i } else { best });
    bytes[largest] += (255 - sum) as u8;
    Some(bytes)
}
