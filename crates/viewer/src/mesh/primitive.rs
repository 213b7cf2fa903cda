//! Reads one primitive: positions, normals, colours, what its vertices follow, indices. Refuses what does not fit.

use gltf::accessor::{DataType, Dimensions};
use gltf::mesh::Mode;

use super::read::{Checked, is_kind};
use super::{Level, MeshError, MeshVertex, Part};

/// What the vertices of a primitive follow.
#[derive(Clone, Copy)]
pub(super) enum Follow {
    Skin { joints: usize },
    One { joint: u8 },
}

/// Joints of every vertex, and how much it follows each.
type Bound = (Vec<[u8; 4]>, Vec<[u8; 4]>);

/// One primitive of a mesh on its way in.
pub(super) struct Primitive<'a, 'b> {
    pub(super) checked: &'b Checked<'a>,
    pub(super) mesh: &'b gltf::Mesh<'a>,
    pub(super) primitive: &'b gltf::Primitive<'a>,
}

impl Primitive<'_, '_> {
    pub(super) fn read(&self, follow: Follow) -> Result<Level, MeshError> {
        let float3 = (Dimensions::Vec3, &[DataType::F32][..]);
        if self.primitive.mode() != Mode::Triangles {
            return Err(self.inconsistent("triangles", format!("{:?}", self.primitive.mode())));
        }
        let count = self.attribute(&gltf::Semantic::Positions, "POSITION", float3)?;
        self.checked.take_vertices(count)?;
        self.same_count(&gltf::Semantic::Normals, "NORMAL", float3, count)?;
        let reader = self.primitive.reader(self.checked.data());
        let positions: Vec<[f32; 3]> = reader.read_positions().into_iter().flatten().collect();
        let normals: Vec<[f32; 3]> = reader.read_normals().into_iter().flatten().collect();
        if let Some(bad) = positions.iter().chain(&normals).flatten().find(|v| !v.is_finite()) {
            return Err(self.inconsistent("finite positions and normals", bad.to_string()));
        }
        let (joints, shares) = self.follow(follow, count)?;
        let colours = self.colours(count)?;
        // Each list has `count` elements: attributes of another number were refused, and absent ones are filled up.
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
        let Some(accessor) = self.primitive.indices() else {
            self.checked.take_indices(count)?;
            return Ok((0..count as u32 / 3 * 3).collect());
        };
        let types = [DataType::U8, DataType::U16, DataType::U32];
        if !is_kind(&accessor, Dimensions::Scalar, &types) || accessor.count() % 3 != 0 {
            return Err(
                self.inconsistent("whole triangles of unsigned indices", format!("{}", accessor.count()))
            );
        }
        self.checked.take_indices(accessor.count())?;
        let reader = self.primitive.reader(self.checked.data());
        let indices: Vec<u32> = reader.read_indices().map(|i| i.into_u32().collect()).unwrap_or_default();
        match indices.iter().find(|&&i| i as usize >= count) {
            Some(index) => Err(self.inconsistent(&format!("indices below {count}"), index.to_string())),
            None => Ok(indices),
        }
    }

    fn follow(&self, follow: Follow, count: usize) -> Result<Bound, MeshError> {
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
        let Some(accessor) = self.primitive.get(&gltf::Semantic::Colors(0)) else {
            return Ok(vec![[255; 4]; count]);
        };
        let types = [DataType::U8, DataType::U16, DataType::F32];
        // gltf panics at any other type.
        if ![Dimensions::Vec3, Dimensions::Vec4].iter().any(|&d| is_kind(&accessor, d, &types)) {
            let found = format!("{:?} of {:?}", accessor.dimensions(), accessor.data_type());
            return Err(self.inconsistent(&format!("COLOR_0 as Vec3 or Vec4 of {types:?}"), found));
        }
        if accessor.count() != count {
            return Err(self.inconsistent(&format!("{count} colours"), accessor.count().to_string()));
        }
        let reader = self.primitive.reader(self.checked.data());
        Ok(reader.read_colors(0).map(|c| c.into_rgba_u8().collect()).unwrap_or_default())
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
    // Rounded down, they sum to 255 at most, so that the rest fits.
    bytes[largest] += (255 - sum) as u8;
    Some(bytes)
}
