//! Scenes with a name: a room, and what a rover sees.

use super::{Bars, Layer, Scene, Shape, Slope, Texture};

/// What the layers of [`Scene::yard`] are, in their order.
pub const YARD: [&str; 6] = ["back", "floor", "fence", "blank wall", "dark corner", "post"];

impl Scene {
    /// A room: a textured back, a slanted side with a thin post before it, a blank wall from the back to the
    /// right and the top with a box before it, the floor that comes nearer, and a ball on it.
    #[must_use]
    pub fn room(seed: u64) -> Self {
        let layer = |shape, disparity, texture| Layer { shape, disparity, texture };
        let rectangle = |columns, rows| Shape::Rectangle { columns, rows };
        let facing = Slope::facing;
        let side = Slope { at_origin: 27.4, per_column: -0.21, per_row: 0.0 };
        let floor = Slope { at_origin: -35.6, per_column: 0.0, per_row: 0.294 };
        let layers = vec![
            layer(Shape::Everywhere, facing(5.3), Texture::new(0, 84.0, 60.0)),
            layer(rectangle([0.0, 96.0], [18.0, 400.0]), side, Texture::new(1, 138.0, 62.0).scaled(1.2)),
            layer(rectangle([112.0, 720.0], [-1.0, 400.0]), facing(14.6), Texture::blank(176.0)),
            layer(rectangle([-400.0, 720.0], [146.0, 400.0]), floor, Texture::new(3, 62.0, 60.0)),
            layer(rectangle([228.0, 292.0], [78.0, 222.0]), facing(30.4), Texture::new(4, 118.0, 90.0).scaled(1.5)),
            layer(rectangle([78.3, 82.8], [0.0, 400.0]), facing(40.2), Texture::new(5, 52.0, 50.0)),
            layer(Shape::Disc { centre: [104.0, 192.0], radius: 27.0 }, facing(36.7), Texture::new(6, 190.0, 64.0)),
        ];
        Self { width: 320, height: 240, num_disparities: 48, layers, blur: 0.0, noise: 1.5, seed }
    }

    /// What confuses a pair of cameras, before a textured back and on a floor: a fence of equal bars, a wall without
    /// texture, a dark corner, and a post that hides a strip of all of them from the right view. The layers are in the
    /// order of [`YARD`].
    #[must_use]
    pub fn yard(seed: u64) -> Self {
        let layer = |shape, disparity, texture| Layer { shape, disparity, texture };
        let rectangle = |columns, rows| Shape::Rectangle { columns, rows };
        let bars = Bars { period: 11.0, share: 0.45, edge: 1.5, depth: 120.0 };
        let floor = Slope { at_origin: -9.0, per_column: 0.0, per_row: 0.14 };
        let layers = vec![
            layer(Shape::Everywhere, Slope::facing(5.4), Texture::new(0, 110.0, 70.0)),
            layer(rectangle([-400.0, 720.0], [158.0, 400.0]), floor, Texture::new(1, 84.0, 70.0).scaled(1.3)),
            layer(rectangle([30.0, 152.0], [16.0, 158.0]), Slope::facing(15.3), Texture::blank(205.0).with_bars(bars)),
            layer(rectangle([180.0, 296.0], [-1.0, 116.0]), Slope::facing(11.6), Texture::blank(168.0)),
            layer(rectangle([236.0, 720.0], [116.0, 400.0]), Slope::facing(22.8), Texture::new(2, 7.0, 5.0)),
            layer(rectangle([140.0, 164.0], [60.0, 224.0]), Slope::facing(38.4), Texture::new(3, 130.0, 90.0)),
        ];
        Self { width: 320, height: 240, num_disparities: 48, layers, blur: 0.5, noise: 1.5, seed }
    }

    /// What a rover sees with the rig of [`haarline_rig::template`], 200 px and 60 mm, level and 300 mm over
    /// the ground: flat ground, straight ahead at 1.5 m a post 100 mm wide and 600 mm high, and a wall at 6 m.
    #[must_use]
    pub fn rover(seed: u64) -> Self {
        let layer = |shape, disparity, texture| Layer { shape, disparity, texture };
        let everything = [-400.0, 720.0];
        // 60 mm / 300 mm for each row below the middle one.
        let ground = Slope { at_origin: -0.2 * 119.5, per_column: 0.0, per_row: 0.2 };
        let post = Shape::Rectangle { columns: [152.8, 166.2], rows: [79.5, 159.5] };
        let layers = vec![
            layer(Shape::Everywhere, Slope::facing(2.0), Texture::new(0, 150.0, 70.0)),
            layer(Shape::Rectangle { columns: everything, rows: [121.0, 400.0] }, ground, Texture::new(1, 96.0, 70.0)),
            layer(post, Slope::facing(8.0), Texture::new(2, 120.0, 90.0)),
        ];
        Self { width: 320, height: 240, num_disparities: 48, layers, blur: 0.0, noise: 1.5, seed }
    }
}
