//! PLY: the scene as points in m, coloured like the left view. x points to the right, y down, z
//! forward from the left camera. Pixels that are unknown or infinitely far are left out.

use crate::{DisparityMap, Frame, Geometry};

/// The file of `map`, in the binary little endian form. What is farther than `max_depth_m` is left out.
///
/// # Panics
/// If `map` and `left` differ in size.
#[must_use]
pub fn encode(map: &DisparityMap, left: &Frame, geometry: &Geometry, max_depth_m: Option<f64>) -> Vec<u8> {
    assert_eq!((map.width, map.height), (left.width, left.height), "map and left view");
    let size = [map.width, map.height];
    let (mut vertices, mut count) = (Vec::new(), 0);
    for (index, &disparity) in map.disparity.iter().enumerate() {
        let at = [index % map.width, index / map.width];
        let is_near = |point: &[f32; 3]| max_depth_m.is_none_or(|most| f64::from(point[2]) <= most);
        if let Some(point) = geometry.point_m(at, size, disparity).filter(is_near) {
            point.iter().for_each(|metres| vertices.extend_from_slice(&metres.to_le_bytes()));
            vertices.extend_from_slice(&colour(left, index));
            count += 1;
        }
    }
    let mut bytes = header(count).into_bytes();
    bytes.append(&mut vertices);
    bytes
}

fn header(vertices: usize) -> String {
    let properties = ["float x", "float y", "float z", "uchar red", "uchar green", "uchar blue"];
    let properties: String = properties.iter().map(|property| format!("property {property}\n")).collect();
    format!(
        "ply\nformat binary_little_endian 1.0\ncomment metres; x right, y down, z forward\n\
         element vertex {vertices}\n{properties}end_header\n"
    )
}

fn colour(left: &Frame, index: usize) -> [u8; 3] {
    match &left.colour {
        Some(rgb) => rgb.get_pixel((index % left.width) as u32, (index / left.width) as u32).0,
        None => [left.luma[index]; 3],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use haarline::Disparity;

    #[test]
    fn known_finite_points_only() {
        let disparity = vec![Disparity::UNKNOWN, Disparity::from_px(8), Disparity::from_px(0)];
        let map = DisparityMap { width: 3, height: 1, disparity, confidence: vec![0, 1, 1] };
        let left = Frame::from_luma(3, 1, vec![10, 20, 30]);
        let geometry = Geometry::new(200.0, 60.0).unwrap();
        let bytes = encode(&map, &left, &geometry, None);
        let header = header(1);
        let vertex = bytes.strip_prefix(header.as_bytes()).unwrap();
        let mut wanted = vec![0; 8];
        wanted.extend_from_slice(&1.5_f32.to_le_bytes());
        wanted.extend_from_slice(&[20, 20, 20]);
        assert_eq!(vertex, wanted);
        assert_eq!(encode(&map, &left, &geometry, Some(1.5)), bytes);
        assert!(encode(&map, &left, &geometry, Some(1.4)).len() < header.len() + 1);
    }
}
