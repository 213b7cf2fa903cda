// The sky: one triangle over the whole picture, behind everything. Hills and towers on the horizon tell where one looks.

struct Varying {
    @builtin(position) clip: vec4f,
    // From the eye; straight lines on the screen are straight lines of it.
    @location(0) direction: vec3f,
}

@vertex
fn vs_main(@builtin(vertex_index) index: u32) -> Varying {
    let at = vec2f(f32(index & 1u), f32(index >> 1u)) * 4.0 - 1.0;
    let far = frame.world_from_clip * vec4f(at, 1.0, 1.0);
    return Varying(vec4f(at, 1.0, 1.0), far.xyz / far.w - frame.eye.xyz);
}

// The product of two complex numbers.
fn times(a: vec2f, b: vec2f) -> vec2f {
    return vec2f(a.x * b.x - a.y * b.y, a.x * b.y + a.y * b.x);
}

// How high a ridge is above the horizon, as a slope, from powers of the direction as a complex number: the cosines and sines of 3, 7, 17 and 43
// times its angle, without the angle. It closes round the whole circle; `turn` tells one ridge from another.
fn ridge(z3: vec2f, z7: vec2f, z17: vec2f, z43: vec2f, turn: f32) -> f32 {
    let a = vec4f(3.0, 7.0, 17.0, 43.0) * turn + vec4f(0.0, 2.1, 0.5, 1.3);
    let height = vec4f(0.020, 0.011, 0.006, 0.002);
    return 0.045 + dot(height * sin(a), vec4f(z3.x, z7.x, z17.x, z43.x))
        + dot(height * cos(a), vec4f(z3.y, z7.y, z17.y, z43.y));
}

// How much of a tower in the direction `at` covers a pixel that is `ahead` on the ground and `slope` above the horizon.
fn tower(ahead: vec2f, slope: f32, pixel: f32, at: vec2f, size: vec2f) -> f32 {
    let aside = abs(ahead.x * at.y - ahead.y * at.x);
    // Narrower towards the top, with a head.
    let top = slope / size.y;
    let width = size.x * select(1.0 - 0.5 * top, 1.25, top > 0.82);
    let inside = min(width - aside, size.y - slope);
    return clamp(inside / pixel + 0.5, 0.0, 1.0) * step(0.0, dot(ahead, at));
}

@fragment
fn fs_main(in: Varying) -> @location(0) vec4f {
    let direction = normalize(in.direction);
    let level = max(length(direction.xy), 1e-4);
    let slope = direction.z / level;
    let pixel = max(fwidth(slope), 1e-5);
    var light = sky(direction);
    // Nothing on the horizon is higher.
    if (slope < 0.2) {
        let ahead = direction.xy / level;
        let z2 = times(ahead, ahead);
        let z3 = times(z2, ahead);
        let z7 = times(times(z3, z3), ahead);
        let z17 = times(times(z7, z7), z3);
        let z43 = times(times(times(z17, z17), z7), z2);
        // The farther, the paler; haze lies at the foot of each.
        let haze = 1.0 - smoothstep(0.0, 0.045, slope);
        let far = mix(vec3f(0.26, 0.35, 0.48), frame.horizon.rgb, 0.25 + 0.35 * haze);
        let near = mix(vec3f(0.13, 0.21, 0.25), frame.horizon.rgb, 0.12 + 0.45 * haze);
        light = mix(light, far, clamp((1.5 * ridge(z3, z7, z17, z43, 0.0) - slope) / pixel + 0.5, 0.0, 1.0));
        var built = tower(ahead, slope, pixel, vec2f(0.9211, 0.3894), vec2f(0.012, 0.15));
        built = max(built, tower(ahead, slope, pixel, vec2f(-0.5048, 0.8632), vec2f(0.028, 0.11)));
        built = max(built, tower(ahead, slope, pixel, vec2f(-0.3233, -0.9463), vec2f(0.008, 0.18)));
        light = mix(light, mix(vec3f(0.20, 0.22, 0.27), frame.horizon.rgb, 0.15 + 0.4 * haze), built);
        light = mix(light, near, clamp((0.75 * ridge(z3, z7, z17, z43, 2.0) - slope) / pixel + 0.5, 0.0, 1.0));
    }
    return vec4f(to_screen(light), 1.0);
}
