// Shows the traced frame and lays the overlay over it, both in one render pass.
//
// Both textures hold sRGB-encoded bytes. A surface that stores bytes as they come gets them as they are, so that
// the window shows exactly the pixels of a saved picture; a surface that encodes by itself gets them decoded first.

// Whether the target encodes linear light to sRGB by itself.
override target_encodes: bool = false;

@group(0) @binding(0) var picture: texture_2d<f32>;
@group(0) @binding(1) var picture_sampler: sampler;

struct Corner {
    @builtin(position) position: vec4<f32>,
    @location(0) uv: vec2<f32>,
}

// One triangle that covers the whole viewport.
@vertex
fn cover(@builtin(vertex_index) index: u32) -> Corner {
    let uv = vec2<f32>(f32((index << 1u) & 2u), f32(index & 2u));
    return Corner(vec4<f32>(uv.x * 2.0 - 1.0, 1.0 - uv.y * 2.0, 0.0, 1.0), uv);
}

fn for_target(encoded: vec4<f32>) -> vec4<f32> {
    if !target_encodes {
        return encoded;
    }
    let low = encoded.rgb / 12.92;
    let high = pow((encoded.rgb + 0.055) / 1.055, vec3<f32>(2.4));
    return vec4<f32>(select(high, low, encoded.rgb <= vec3<f32>(0.04045)), encoded.a);
}

// The frame has the viewport's size: pixel for pixel. In the middle of a pixel the product is half a texel away from
// where rounding could matter.
@fragment
fn frame_exact(corner: Corner) -> @location(0) vec4<f32> {
    let texel = vec2<i32>(corner.uv * vec2<f32>(textureDimensions(picture)));
    return vec4<f32>(for_target(textureLoad(picture, texel, 0)).rgb, 1.0);
}

// The frame has another size: stretched.
@fragment
fn frame_scaled(corner: Corner) -> @location(0) vec4<f32> {
    return vec4<f32>(for_target(textureSampleLevel(picture, picture_sampler, corner.uv, 0.0)).rgb, 1.0);
}

// The overlay has the target's size; its colours are premultiplied by its alpha.
@fragment
fn overlay(corner: Corner) -> @location(0) vec4<f32> {
    return for_target(textureLoad(picture, vec2<i32>(corner.position.xy), 0));
}
