// What every shader shares: the frame, light, shadow and the way to the screen. World space, z up, metres.

struct Frame {
    clip_from_world: mat4x4f,
    world_from_clip: mat4x4f,
    sun_clip_from_world: mat4x4f,
    // xyz; w: exposure
    eye: vec4f,
    // unit vector to the sun; w: number of shadow taps
    to_sun: vec4f,
    // linear radiance; w: width of the penumbra on the shadow map, in texture coordinates
    sun: vec4f,
    zenith: vec4f,
    horizon: vec4f,
    bounce: vec4f,
    // where on the shadow map something casts: min xy, max xy
    casters: vec4f,
    // distance at which the ground begins and ends to fade, world size of a shadow texel, unused
    fade: vec4f,
}

@group(0) @binding(0) var<uniform> frame: Frame;
@group(1) @binding(0) var shadow_map: texture_depth_2d;
@group(1) @binding(1) var shadow_sampler: sampler_comparison;

const PI = 3.14159265;

// Share of the sun that reaches a point: a disc of taps on the shadow map. The loop runs only where
// something casts, which a software renderer notices.
fn sunlight(position: vec3f, normal: vec3f) -> f32 {
    let lifted = position + normal * frame.fade.z * 1.6;
    let clip = frame.sun_clip_from_world * vec4f(lifted, 1.0);
    let uv = vec2f(clip.x, -clip.y) * 0.5 + 0.5;
    let inside = all(uv > frame.casters.xy) && all(uv < frame.casters.zw);
    let taps = select(0, i32(frame.to_sun.w), inside && dot(normal, frame.to_sun.xyz) > 0.0);
    var lit = 0.0;
    // A sunflower spiral covers the disc evenly: each tap is turned by the golden angle.
    var toward = vec2f(frame.sun.w, 0.0);
    for (var i = 0; i < taps; i++) {
        let offset = toward * sqrt((f32(i) + 0.5) / frame.to_sun.w);
        lit += textureSampleCompareLevel(shadow_map, shadow_sampler, uv + offset, clip.z - 0.0006);
        toward = vec2f(-0.737369 * toward.x - 0.675490 * toward.y, 0.675490 * toward.x - 0.737369 * toward.y);
    }
    return select(1.0, lit / max(frame.to_sun.w, 1.0), taps > 0);
}

fn power5(x: f32) -> f32 {
    let x2 = x * x;
    return x2 * x2 * x;
}

fn power16(x: f32) -> f32 {
    let x2 = x * x;
    let x4 = x2 * x2;
    let x8 = x4 * x4;
    return x8 * x8;
}

fn sky(direction: vec3f) -> vec3f {
    let up = clamp(direction.z, 0.0, 1.0);
    let down = 1.0 - up;
    let gradient = mix(frame.horizon.rgb, frame.zenith.rgb, 1.0 - down * down * down);
    let glow = power16(max(dot(direction, frame.to_sun.xyz), 0.0));
    return gradient + frame.sun.rgb * glow * 0.06;
}

// Light from the whole sky and from the ground, on a surface that faces `normal`.
fn ambient(normal: vec3f) -> vec3f {
    let up = normal.z * 0.5 + 0.5;
    return mix(frame.bounce.rgb, mix(frame.horizon.rgb, frame.zenith.rgb, 0.45), up);
}

// Cook-Torrance with GGX, plus sky light; `open` is the share of the sky that is not hidden.
fn shade(position: vec3f, normal: vec3f, colour: vec3f, roughness: f32, metallic: f32, open: f32) -> vec3f {
    let to_eye = normalize(frame.eye.xyz - position);
    let half_way = normalize(to_eye + frame.to_sun.xyz);
    let n_sun = max(dot(normal, frame.to_sun.xyz), 0.0);
    let n_eye = max(dot(normal, to_eye), 1e-3);
    let n_half = max(dot(normal, half_way), 0.0);
    let alpha = roughness * roughness;
    let alpha2 = alpha * alpha;
    let spread = n_half * n_half * (alpha2 - 1.0) + 1.0;
    let distribution = alpha2 / (PI * spread * spread);
    let k = (roughness + 1.0) * (roughness + 1.0) / 8.0;
    let visibility = 0.25 / ((n_eye * (1.0 - k) + k) * (n_sun * (1.0 - k) + k));
    let f0 = mix(vec3f(0.04), colour, metallic);
    let fresnel = f0 + (1.0 - f0) * power5(1.0 - max(dot(half_way, to_eye), 0.0));
    let diffuse = colour * (1.0 - metallic);
    let direct = (diffuse * (1.0 - fresnel) / PI + fresnel * distribution * visibility) * n_sun;
    let edge = f0 + (max(vec3f(1.0 - roughness), f0) - f0) * power5(1.0 - n_eye);
    let mirrored = ambient(reflect(-to_eye, normal)) * edge * (1.0 - 0.5 * roughness);
    let sun = frame.sun.rgb * sunlight(position, normal);
    return direct * sun + (diffuse * ambient(normal) + mirrored) * open;
}

// Exposure, then a filmic curve that contains the transfer function of the screen (Hejl and Burgess-Dawson):
// one division, which matters without a graphics card.
fn to_screen(radiance: vec3f) -> vec3f {
    let x = max(radiance * frame.eye.w - 0.004, vec3f(0.0));
    return x * (6.2 * x + 0.5) / (x * (6.2 * x + 1.7) + 0.06);
}
