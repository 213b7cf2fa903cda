// The ground: a matt floor with a grid that fades into the haze.

struct Varying {
    @builtin(position) clip: vec4f,
    @location(0) position: vec3f,
    @location(1) normal: vec3f,
}

@vertex
fn vs_main(@location(0) position: vec3f, @location(1) normal: vec3f) -> Varying {
    return Varying(frame.clip_from_world * vec4f(position, 1.0), position, normal);
}

// How much of a line of `width` metres, one every `spacing`, covers the pixel. `per` is one over twice the
// footprint of the pixel, metres.
fn grid(p: vec2f, spacing: f32, width: f32, per: vec2f) -> f32 {
    let from_line = abs(fract(p * (1.0 / spacing) - 0.5) - 0.5) * spacing;
    let cover = clamp((width - from_line) * per + 0.5, vec2f(0.0), vec2f(1.0));
    let thin = min(2.0 * width * per, vec2f(1.0));
    let line = cover * thin;
    return max(line.x, line.y);
}

@fragment
fn fs_main(in: Varying) -> @location(0) vec4f {
    let p = in.position.xy;
    let footprint = fwidth(p);
    let per = 0.5 / max(footprint, vec2f(1e-5));
    let normal = normalize(in.normal);
    let away = frame.eye.xyz - in.position;
    let reach = length(away);
    let tile = floor(p * 0.5);
    let checker = fract((tile.x + tile.y) * 0.5) * 2.0;
    let fine = 1.0 - smoothstep(0.03, 0.12, max(footprint.x, footprint.y));
    var colour = mix(vec3f(0.118, 0.128, 0.142), vec3f(0.098, 0.108, 0.122), checker * clamp(1.2 - reach / 40.0, 0.0, 1.0));
    colour = mix(colour, vec3f(0.27, 0.29, 0.32), grid(p, 1.0, 0.006, per) * 0.75);
    colour = mix(colour, vec3f(0.20, 0.21, 0.23), grid(p, 0.25, 0.003, per) * 0.30 * fine);
    let n_sun = max(dot(normal, frame.to_sun.xyz), 0.0);
    let direct = frame.sun.rgb * n_sun / PI * sunlight(in.position, normal);
    var light = colour * (direct + ambient(normal));
    let grazing = power5(1.0 - clamp(dot(normal, away / reach), 0.0, 1.0));
    light += frame.horizon.rgb * grazing * 0.22;
    let haze = smoothstep(frame.fade.x, frame.fade.y, reach);
    return vec4f(to_screen(mix(light, frame.horizon.rgb, haze)), 1.0);
}
