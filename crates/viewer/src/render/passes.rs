//! The two passes of a picture: the shadows that the light casts, and what the camera sees.

use std::ops::Range;

use super::Renderer;
use super::buffers::Growing;
use super::scene::{Part, SOLIDS};
use super::upload::Counts;

impl Renderer {
    pub(super) fn draw_shadows(&self, encoder: &mut wgpu::CommandEncoder, counts: &Counts) {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("shadows"),
            depth_stencil_attachment: Some(depth_attachment(&self.shadow_map, wgpu::StoreOp::Store)),
            ..Default::default()
        });
        pass.set_bind_group(0, &self.frame_group, &[]);
        pass.set_pipeline(&self.pipelines.thing_shadow);
        self.draw_solids(&mut pass, &self.things, &counts.things);
        let Some(buffers) = &self.mesh_buffers else { return };
        pass.set_pipeline(&self.pipelines.skinned_shadow);
        pass.set_bind_group(2, &self.figures_group, &[]);
        pass.set_vertex_buffer(1, self.instances.buffer().slice(..));
        for (level, figures) in counts.figures.shadows(buffers.levels.len()) {
            let level = &buffers.levels[level];
            pass.set_vertex_buffer(0, level.vertices.slice(..));
            pass.set_index_buffer(level.indices.slice(..), wgpu::IndexFormat::Uint32);
            let end = level.parts.iter().map(|p| p.1.end).max().unwrap_or(0);
            pass.draw_indexed(0..end, 0, figures);
        }
    }

    pub(super) fn draw_picture(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        view: &wgpu::TextureView,
        part: Part,
        counts: &Counts,
    ) {
        let targets = self.targets.as_ref().expect("made by draw");
        let (view, resolve_target, store) = match &targets.colour {
            Some(colour) if part.last => (colour, Some(view), wgpu::StoreOp::Discard),
            // The other parts are drawn beside it first.
            Some(colour) => (colour, None, wgpu::StoreOp::Store),
            None => (view, None, wgpu::StoreOp::Store),
        };
        let load = if part.first { wgpu::LoadOp::Clear(wgpu::Color::BLACK) } else { wgpu::LoadOp::Load };
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("picture"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target,
                ops: wgpu::Operations { load, store },
            })],
            depth_stencil_attachment: Some(depth_attachment(&targets.depth, wgpu::StoreOp::Discard)),
            ..Default::default()
        });
        let height = targets.size[1];
        pass.set_viewport(part.left as f32, 0.0, part.width as f32, height as f32, 0.0, 1.0);
        pass.set_scissor_rect(part.left, 0, part.width, height);
        pass.set_bind_group(0, &self.frame_group, &[]);
        pass.set_bind_group(1, &self.shadow_group, &[]);
        self.draw_figures(&mut pass, counts);
        pass.set_pipeline(&self.pipelines.thing);
        self.draw_solids(&mut pass, &self.things, &counts.things);
        pass.set_pipeline(&self.pipelines.ground);
        pass.set_vertex_buffer(0, self.ground.0.slice(..));
        pass.draw(0..self.ground.1, 0..1);
        if counts.contacts > 0 {
            pass.set_pipeline(&self.pipelines.contact);
            pass.set_vertex_buffer(0, self.contacts.buffer().slice(..));
            pass.draw(0..4, 0..counts.contacts);
        }
        pass.set_pipeline(&self.pipelines.sky);
        pass.draw(0..3, 0..1);
        if counts.ribbons > 0 {
            pass.set_pipeline(&self.pipelines.ribbon);
            pass.set_vertex_buffer(0, self.ribbons.buffer().slice(..));
            pass.draw(0..counts.ribbons, 0..1);
        }
        pass.set_pipeline(&self.pipelines.shape);
        self.draw_solids(&mut pass, &self.markers, &counts.markers);
    }

    /// One draw call for each kind of solid that there is.
    fn draw_solids(&self, pass: &mut wgpu::RenderPass<'_>, placed: &Growing, counts: &[Range<u32>; SOLIDS]) {
        pass.set_vertex_buffer(0, self.solids.0.slice(..));
        pass.set_vertex_buffer(1, placed.buffer().slice(..));
        for (vertices, instances) in self.solids.1.iter().zip(counts).filter(|(_, some)| !some.is_empty()) {
            pass.draw(vertices.clone(), instances.clone());
        }
    }

    /// One draw call for each material of each level, however many figures there are.
    fn draw_figures(&self, pass: &mut wgpu::RenderPass<'_>, counts: &Counts) {
        let Some(buffers) = &self.mesh_buffers else { return };
        pass.set_pipeline(&self.pipelines.skinned);
        pass.set_bind_group(2, &self.figures_group, &[]);
        pass.set_vertex_buffer(1, self.instances.buffer().slice(..));
        for (level, figures) in buffers.levels.iter().zip(&counts.figures.levels) {
            if figures.is_empty() {
                continue;
            }
            pass.set_vertex_buffer(0, level.vertices.slice(..));
            pass.set_index_buffer(level.indices.slice(..), wgpu::IndexFormat::Uint32);
            for (material, indices) in &level.parts {
                pass.set_bind_group(3, &buffers.materials[*material], &[]);
                pass.draw_indexed(indices.clone(), 0, figures.clone());
            }
        }
    }
}

fn depth_attachment(
    view: &wgpu::TextureView,
    store: wgpu::StoreOp,
) -> wgpu::RenderPassDepthStencilAttachment<'_> {
    let depth_ops = Some(wgpu::Operations { load: wgpu::LoadOp::Clear(1.0), store });
    wgpu::RenderPassDepthStencilAttachment { view, depth_ops, stencil_ops: None }
}
