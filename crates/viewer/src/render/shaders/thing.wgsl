// Things of the world: solids in one colour each, lit as the ground is, with marks that show rotation and size.

struct Varying {
    @builtin(position) clip: vec4f,
    @location(0) normal: vec3f,
    @location(1) colour: vec4f,
    @location(2) position: vec3f,
    // in the frame of the solid, from -1 to 1
    @location(3) unit: vec3f,
    // half the sides, metres
    @location(4) @interpolate(flat) half_size: vec3f,
}

@vertex
fn vs_main(
    @location(0) position: vec3f,
    @location(1) normal: vec3f,
    @location(2) row_x: vec4f,
    @location(3) row_y: vec4f,
    @location(4) row_z: vec4f,
    @location(5) colour: vec4f,
) -> Varying {
    let at = placed(position, normal, row_x, row_y, row_z);
    let clip = frame.clip_from_world * vec4f(at.world, 1.0);
    return Varying(clip, at.normal, colour, at.world, position, at.half_size);
}

@vertex
fn vs_shadow(
    @location(0) position: vec3f,
    @location(1) normal: vec3f,
    @location(2) row_x: vec4f,
    @location(3) row_y: vec4f,
    @location(4) row_z: vec4f,
) -> @builtin(position) vec4f {
    let at = placed(position, normal, row_x, row_y, row_z);
    return frame.sun_clip_from_world * vec4f(at.world, 1.0);
}

// How near to an edge of its cube a point of a face is, metres: the second least of the distances to the faces.
fn from_edge(unit: vec3f, half_size: vec3f) -> f32 {
    let d = (vec3f(1.0) - abs(unit)) * half_size;
    return max(min(d.x, d.y), min(max(d.x, d.y), d.z));
}

@fragment
fn fs_main(in: Varying) -> @location(0) vec4f {
    let normal = normalize(in.normal);
    var colour = in.colour.rgb;
    let edge = from_edge(in.unit, in.half_size);
    let width = max(fwidth(edge), 0.004);
    if (in.colour.a > 0.9) {
        // A quarter of a side at most, so that thin things keep their colour.
        let least = min(in.half_size.x, min(in.half_size.y, in.half_size.z));
        colour *= mix(0.55, 1.0, smoothstep(0.0, width, edge - min(0.025, 0.25 * least)));
    } else {
        let octant = in.unit.x * in.unit.y * in.unit.z;
        colour = mix(colour, vec3f(0.75), select(0.0, 0.65, octant > 0.0));
    }
    let light = shade(in.position, normal, colour, 0.75, 0.0, 0.85 + 0.15 * normal.z);
    let reach = length(frame.eye.xyz - in.position);
    let haze = smoothstep(frame.fade.x, frame.fade.y, reach);
    return vec4f(to_screen(mix(light, frame.horizon.rgb, haze)), 1.0);
}
