//! The immutable half of the renderer: bind group layouts and pipelines.

use super::config::RenderConfig;
use super::gpu_data::{ContactData, InstanceData, MarkerData};
use super::scene::RibbonVertex;
use super::solids::SolidVertex;
use crate::mesh::MeshVertex;

/// Format of every depth buffer.
pub(super) const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// Every shader by name, complete with what they share. For the pipelines, and for checks of the shaders.
pub const SHADERS: [(&str, &str); 7] = [
    ("skinned", concat!(include_str!("shaders/common.wgsl"), include_str!("shaders/skinned.wgsl"))),
    ("ground", concat!(include_str!("shaders/common.wgsl"), include_str!("shaders/ground.wgsl"))),
    ("contact", concat!(include_str!("shaders/common.wgsl"), include_str!("shaders/contact.wgsl"))),
    ("sky", concat!(include_str!("shaders/common.wgsl"), include_str!("shaders/sky.wgsl"))),
    (
        "shape",
        concat!(
            include_str!("shaders/common.wgsl"),
            include_str!("shaders/placed.wgsl"),
            include_str!("shaders/shape.wgsl")
        ),
    ),
    (
        "thing",
        concat!(
            include_str!("shaders/common.wgsl"),
            include_str!("shaders/placed.wgsl"),
            include_str!("shaders/thing.wgsl")
        ),
    ),
    ("ribbon", concat!(include_str!("shaders/common.wgsl"), include_str!("shaders/ribbon.wgsl"))),
];

/// Layouts of the bind groups by number.
#[derive(Debug)]
pub(super) struct Layouts {
    pub(super) frame: wgpu::BindGroupLayout,
    pub(super) shadow: wgpu::BindGroupLayout,
    pub(super) figures: wgpu::BindGroupLayout,
    pub(super) material: wgpu::BindGroupLayout,
}

/// All pipelines.
#[derive(Debug)]
pub(super) struct Pipelines {
    pub(super) skinned: wgpu::RenderPipeline,
    pub(super) skinned_shadow: wgpu::RenderPipeline,
    pub(super) ground: wgpu::RenderPipeline,
    pub(super) contact: wgpu::RenderPipeline,
    pub(super) sky: wgpu::RenderPipeline,
    pub(super) shape: wgpu::RenderPipeline,
    pub(super) thing: wgpu::RenderPipeline,
    pub(super) thing_shadow: wgpu::RenderPipeline,
    pub(super) ribbon: wgpu::RenderPipeline,
}

impl Layouts {
    pub(super) fn new(device: &wgpu::Device) -> Self {
        use wgpu::{BindingType, BufferBindingType, SamplerBindingType, ShaderStages};
        let layout = |label, visibility, types: &[BindingType]| {
            let entries: Vec<wgpu::BindGroupLayoutEntry> = types
                .iter()
                .zip(0..)
                .map(|(&ty, binding)| wgpu::BindGroupLayoutEntry { binding, visibility, ty, count: None })
                .collect();
            device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
                label: Some(label),
                entries: &entries,
            })
        };
        let buffer = |ty| BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None };
        let uniform = buffer(BufferBindingType::Uniform);
        let texture = |sample_type| BindingType::Texture {
            sample_type,
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: false,
        };
        let map = texture(wgpu::TextureSampleType::Depth);
        let rows = texture(wgpu::TextureSampleType::Float { filterable: false });
        let comparison = BindingType::Sampler(SamplerBindingType::Comparison);
        Self {
            frame: layout("frame", ShaderStages::VERTEX_FRAGMENT, &[uniform]),
            shadow: layout("shadow", ShaderStages::FRAGMENT, &[map, comparison]),
            figures: layout("figures", ShaderStages::VERTEX, &[rows]),
            material: layout("material", ShaderStages::FRAGMENT, &[uniform]),
        }
    }
}

/// What differs between the pipelines.
struct Recipe<'a> {
    name: &'static str,
    groups: &'a [Option<&'a wgpu::BindGroupLayout>],
    buffers: &'a [Option<wgpu::VertexBufferLayout<'a>>],
    topology: wgpu::PrimitiveTopology,
    cull: Option<wgpu::Face>,
    blend: bool,
    depth: (bool, wgpu::CompareFunction),
    /// Pulls the surface towards the eye, depth units.
    bias: i32,
}

/// Makes pipelines that draw into one kind of target.
struct Maker<'a> {
    device: &'a wgpu::Device,
    format: wgpu::TextureFormat,
    samples: u32,
}

impl Maker<'_> {
    fn make(&self, recipe: &Recipe<'_>) -> wgpu::RenderPipeline {
        let module = shader(self.device, recipe.name);
        let blend = recipe.blend.then_some(wgpu::BlendState::ALPHA_BLENDING);
        let target =
            wgpu::ColorTargetState { format: self.format, blend, write_mask: wgpu::ColorWrites::ALL };
        let depth = depth_state(recipe.depth, recipe.bias, 0.0);
        self.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(recipe.name),
            layout: Some(&pipeline_layout(self.device, recipe.groups)),
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("vs_main"),
                buffers: recipe.buffers,
                compilation_options: wgpu::PipelineCompilationOptions::default(),
            },
            primitive: wgpu::PrimitiveState {
                topology: recipe.topology,
                cull_mode: recipe.cull,
                ..Default::default()
            },
            depth_stencil: Some(depth),
            multisample: wgpu::MultisampleState { count: self.samples, ..Default::default() },
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some("fs_main"),
                targets: &[Some(target)],
                compilation_options: wgpu::PipelineCompilationOptions::default(),
            }),
            multiview_mask: None,
            cache: None,
        })
    }
}

impl Pipelines {
    pub(super) fn new(
        device: &wgpu::Device,
        layouts: &Layouts,
        format: wgpu::TextureFormat,
        config: &RenderConfig,
    ) -> Self {
        use wgpu::CompareFunction::{Less, LessEqual};
        use wgpu::PrimitiveTopology::{TriangleList, TriangleStrip};
        let maker = Maker { device, format, samples: config.samples };
        let frame = Some(&layouts.frame);
        let lit = [frame, Some(&layouts.shadow)];
        let plain = Recipe {
            name: "sky",
            groups: &[frame],
            buffers: &[],
            topology: TriangleList,
            cull: None,
            blend: false,
            depth: (false, LessEqual),
            bias: 0,
        };
        let sky = maker.make(&plain);
        let figures =
            [Some(mesh_layout()), Some(layout_of::<InstanceData>(wgpu::VertexStepMode::Instance, &INSTANCE))];
        let skinned = maker.make(&Recipe {
            name: "skinned",
            groups: &[frame, Some(&layouts.shadow), Some(&layouts.figures), Some(&layouts.material)],
            buffers: &figures,
            cull: Some(wgpu::Face::Back),
            depth: (true, Less),
            ..plain
        });
        let solid = Some(layout_of::<SolidVertex>(wgpu::VertexStepMode::Vertex, &SOLID));
        let ground = maker.make(&Recipe {
            name: "ground",
            groups: &lit,
            buffers: std::slice::from_ref(&solid),
            depth: (true, Less),
            ..plain
        });
        let contact = maker.make(&Recipe {
            name: "contact",
            buffers: &[Some(layout_of::<ContactData>(wgpu::VertexStepMode::Instance, &CONTACT))],
            topology: TriangleStrip,
            blend: true,
            bias: -40,
            ..plain
        });
        let instanced = [solid, Some(layout_of::<MarkerData>(wgpu::VertexStepMode::Instance, &MARKER))];
        let thing = maker.make(&Recipe {
            name: "thing",
            groups: &lit,
            buffers: &instanced,
            depth: (true, Less),
            ..plain
        });
        let shape = maker.make(&Recipe {
            name: "shape",
            buffers: &instanced,
            blend: true,
            depth: (true, LessEqual),
            ..plain
        });
        let ribbon = maker.make(&Recipe {
            name: "ribbon",
            buffers: &[Some(layout_of::<RibbonVertex>(wgpu::VertexStepMode::Vertex, &RIBBON))],
            blend: true,
            ..plain
        });
        let groups = [frame, None, Some(&layouts.figures)];
        let back = Some(wgpu::Face::Back);
        let skinned_shadow = shadow_pipeline(device, "skinned", &groups, &figures, back);
        let thing_shadow = shadow_pipeline(device, "thing", &groups[..1], &instanced, None);
        Self { skinned, skinned_shadow, ground, contact, sky, shape, thing, thing_shadow, ribbon }
    }
}

fn shadow_pipeline(
    device: &wgpu::Device,
    name: &'static str,
    groups: &[Option<&wgpu::BindGroupLayout>],
    buffers: &[Option<wgpu::VertexBufferLayout<'_>>],
    cull_mode: Option<wgpu::Face>,
) -> wgpu::RenderPipeline {
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("shadow"),
        layout: Some(&pipeline_layout(device, groups)),
        vertex: wgpu::VertexState {
            module: &shader(device, name),
            entry_point: Some("vs_shadow"),
            buffers,
            compilation_options: wgpu::PipelineCompilationOptions::default(),
        },
        primitive: wgpu::PrimitiveState { cull_mode, ..Default::default() },
        depth_stencil: Some(depth_state((true, wgpu::CompareFunction::Less), 2, 1.5)),
        multisample: wgpu::MultisampleState::default(),
        fragment: None,
        multiview_mask: None,
        cache: None,
    })
}

fn shader(device: &wgpu::Device, name: &'static str) -> wgpu::ShaderModule {
    let source = SHADERS.iter().find(|s| s.0 == name).expect("every pipeline is named after a shader").1;
    device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some(name),
        source: wgpu::ShaderSource::Wgsl(source.into()),
    })
}

fn pipeline_layout(device: &wgpu::Device, groups: &[Option<&wgpu::BindGroupLayout>]) -> wgpu::PipelineLayout {
    device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: None,
        bind_group_layouts: groups,
        immediate_size: 0,
    })
}

fn depth_state(
    (write, compare): (bool, wgpu::CompareFunction),
    constant: i32,
    slope_scale: f32,
) -> wgpu::DepthStencilState {
    wgpu::DepthStencilState {
        format: DEPTH,
        depth_write_enabled: Some(write),
        depth_compare: Some(compare),
        stencil: wgpu::StencilState::default(),
        bias: wgpu::DepthBiasState { constant, slope_scale, clamp: 0.0 },
    }
}

const MESH: [wgpu::VertexAttribute; 5] =
    wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Unorm8x4, 3 => Uint8x4, 4 => Unorm8x4];
const INSTANCE: [wgpu::VertexAttribute; 3] =
    wgpu::vertex_attr_array![5 => Float32x4, 6 => Float32, 7 => Uint32];
const SOLID: [wgpu::VertexAttribute; 2] = wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3];
const CONTACT: [wgpu::VertexAttribute; 3] =
    wgpu::vertex_attr_array![0 => Float32x4, 1 => Float32x4, 2 => Float32x4];
const MARKER: [wgpu::VertexAttribute; 4] =
    wgpu::vertex_attr_array![2 => Float32x4, 3 => Float32x4, 4 => Float32x4, 5 => Float32x4];
const RIBBON: [wgpu::VertexAttribute; 2] = wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x4];

fn mesh_layout() -> wgpu::VertexBufferLayout<'static> {
    layout_of::<MeshVertex>(wgpu::VertexStepMode::Vertex, &MESH)
}

fn layout_of<T>(
    step_mode: wgpu::VertexStepMode,
    attributes: &'static [wgpu::VertexAttribute],
) -> wgpu::VertexBufferLayout<'static> {
    wgpu::VertexBufferLayout { array_stride: size_of::<T>() as u64, step_mode, attributes }
}
