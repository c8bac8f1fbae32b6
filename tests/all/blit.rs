//! The blit, drawn offscreen: what a frame holds is what the target gets.

use raywalk::app::present::PixelRect;
use raywalk::app::present::blit::{BYTES, Blit};
use wgpu::TextureFormat;

/// Device and queue of any adapter. Without one the test is left out, except where that must not happen unnoticed.
fn device() -> Option<(wgpu::Device, wgpu::Queue)> {
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
    let adapter = match pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default())) {
        Ok(adapter) => adapter,
        Err(error) => {
            assert!(std::env::var_os("CI").is_none(), "no graphics adapter: {error}");
            println!("left out: no graphics adapter");
            return None;
        }
    };
    let limits = wgpu::Limits::downlevel_webgl2_defaults().using_resolution(adapter.limits());
    let description = wgpu::DeviceDescriptor { required_limits: limits, ..Default::default() };
    Some(pollster::block_on(adapter.request_device(&description)).expect("an adapter gives a device"))
}

/// Pixels in every byte value, different along both axes.
fn pattern(width: u32, height: u32) -> Vec<u8> {
    (0..height)
        .flat_map(|y| (0..width).flat_map(move |x| [x as u8, y as u8, (x * 7 + y * 13) as u8, (x ^ y) as u8]))
        .collect()
}

fn texture(device: &wgpu::Device, width: u32, height: u32, format: TextureFormat) -> wgpu::Texture {
    device.create_texture(&wgpu::TextureDescriptor {
        label: None,
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT
            | wgpu::TextureUsages::TEXTURE_BINDING
            | wgpu::TextureUsages::COPY_DST
            | wgpu::TextureUsages::COPY_SRC,
        view_formats: &[],
    })
}

/// The target's bytes. Its rows must be multiples of 256 bytes.
fn read(device: &wgpu::Device, queue: &wgpu::Queue, target: &wgpu::Texture) -> Vec<u8> {
    let row = 4 * target.width();
    let buffer = device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: u64::from(row) * u64::from(target.height()),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row), rows_per_image: None };
    let copy = wgpu::TexelCopyBufferInfo { buffer: &buffer, layout };
    encoder.copy_texture_to_buffer(target.as_image_copy(), copy, target.size());
    queue.submit([encoder.finish()]);
    buffer.slice(..).map_async(wgpu::MapMode::Read, |mapped| mapped.expect("the buffer can be read"));
    device.poll(wgpu::PollType::wait_indefinitely()).expect("the device answers");
    buffer.slice(..).get_mapped_range().expect("it is mapped").to_vec()
}

/// Blits a frame of one size to a target of another and returns the target's bytes.
fn blit(format: TextureFormat, frame: (u32, u32), target: (u32, u32)) -> Option<Vec<u8>> {
    blit_to(format, frame, target, [0, 0, target.0, target.1])
}

/// The same, to a part of the target.
fn blit_to(format: TextureFormat, frame: (u32, u32), target: (u32, u32), place: PixelRect) -> Option<Vec<u8>> {
    let (device, queue) = device()?;
    let target = texture(&device, target.0, target.1, format);
    let mut blit = Blit::new(&device, format);
    blit.upload(&device, &queue, frame.0, frame.1, &pattern(frame.0, frame.1));
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    blit.draw(&mut encoder, &target, place, None);
    queue.submit([encoder.finish()]);
    Some(read(&device, &queue, &target))
}

fn opaque(mut rgba: Vec<u8>) -> Vec<u8> {
    rgba.chunks_exact_mut(4).for_each(|pixel| pixel[3] = 255);
    rgba
}

#[test]
fn a_frame_of_the_targets_size_arrives_byte_for_byte() {
    let expected = opaque(pattern(256, 144));
    let Some(plain) = blit(TextureFormat::Rgba8Unorm, (256, 144), (256, 144)) else { return };
    assert!(plain == expected, "a target that stores bytes");
    let Some(encoding) = blit(TextureFormat::Rgba8UnormSrgb, (256, 144), (256, 144)) else { return };
    let worst = encoding.iter().zip(&expected).map(|(a, b)| a.abs_diff(*b)).max();
    assert!(worst <= Some(1), "a target that encodes by itself, after decoding in f32: off by {worst:?}");
    let Some(mut swapped) = blit(TextureFormat::Bgra8Unorm, (256, 144), (256, 144)) else { return };
    swapped.chunks_exact_mut(4).for_each(|pixel| pixel.swap(0, 2));
    assert!(swapped == expected, "a target in another order");
}

#[test]
fn a_frame_of_another_size_fills_the_target() {
    let Some(pixels) = blit(TextureFormat::Rgba8Unorm, (32, 16), (256, 144)) else { return };
    let at = |x: usize, y: usize| &pixels[4 * (256 * y + x)..][..4];
    assert_eq!(at(0, 0)[..2], [0, 0], "the first pixel is in the upper left corner");
    assert_eq!(at(255, 143)[..2], [31, 15], "and the last in the lower right one");
    assert!(pixels.chunks_exact(4).all(|pixel| pixel[3] == 255));
}

#[test]
fn a_frame_beside_the_panel_arrives_byte_for_byte_and_leaves_the_rest_black() {
    let Some(pixels) = blit_to(TextureFormat::Rgba8Unorm, (185, 144), (256, 144), [71, 0, 185, 144]) else { return };
    let expected = opaque(pattern(185, 144));
    for (row, frame) in pixels.chunks_exact(4 * 256).zip(expected.chunks_exact(4 * 185)) {
        assert!(row[..4 * 71].chunks_exact(4).all(|pixel| pixel == [0, 0, 0, 255]));
        assert!(row[4 * 71..] == *frame);
    }
    let Some(pixels) = blit_to(TextureFormat::Rgba8Unorm, (32, 16), (256, 144), [128, 0, 128, 144]) else { return };
    let at = |x: usize, y: usize| &pixels[4 * (256 * y + x)..][..4];
    assert_eq!((&at(127, 143)[..3], &at(128, 0)[..2], &at(255, 143)[..2]), (&[0; 3][..], &[0, 0][..], &[31, 15][..]));
}

#[test]
fn the_overlay_covers_its_own_part_only() {
    let Some((device, queue)) = device() else { return };
    let (width, height) = (64, 32);
    let target = texture(&device, width, height, BYTES);
    let layer = texture(&device, width, height, BYTES);
    let half_red = [100_u8, 0, 0, 128].repeat((width * height) as usize);
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4 * width), rows_per_image: None };
    queue.write_texture(layer.as_image_copy(), &half_red, layout, layer.size());
    let mut blit = Blit::new(&device, BYTES);
    blit.upload(&device, &queue, width, height, &[200; 64 * 32 * 4]);
    let bound = blit.bind(&device, &layer.create_view(&wgpu::TextureViewDescriptor::default()));
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    blit.draw(&mut encoder, &target, [0, 0, width, height], Some((&bound, [8, 4, 16, 8])));
    queue.submit([encoder.finish()]);
    let pixels = read(&device, &queue, &target);
    for y in 0..height {
        for x in 0..width {
            let pixel = &pixels[(4 * (width * y + x)) as usize..][..4];
            let inside = (8..24).contains(&x) && (4..12).contains(&y);
            // 200 shows through a layer of alpha 128 as 200 · 127/255 = 99.6.
            let expected = if inside { [200, 100, 100, 255] } else { [200, 200, 200, 255] };
            assert!(pixel.iter().zip(expected).all(|(a, b)| a.abs_diff(b) <= 1), "({x}, {y}): {pixel:?}");
        }
    }
}
