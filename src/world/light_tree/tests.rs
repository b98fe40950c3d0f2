//! Tests of light trees and of their packing.

use glam::Vec3;

use super::{Cluster, LIGHT_LEAF, Leaf, NO_NODE, Node, Sides, Tree, build, build::MOST_LEVELS};

fn leaf(center: Vec3, item: u32) -> Leaf {
    let cluster = Cluster {
        center,
        radius: 0.25,
        axis: Vec3::new(1.0, (item % 7) as f32 - 3.0, 0.5).normalize(),
        cosine: 1.0,
        power: 1.0 + (item % 5) as f32,
        sides: Sides::Front,
    };
    Leaf::ball(cluster, item)
}

/// Levels of a tree, and how often it has each item, which the node above contains.
fn checked(tree: &Tree, items: usize) -> (u32, Vec<u32>) {
    let mut found = vec![0; items];
    let mut deepest = 0;
    let mut open = vec![(tree.link, NO_NODE, tree.root, 0)];
    while let Some((link, node, cluster, level)) = open.pop() {
        deepest = deepest.max(level);
        if link & LIGHT_LEAF != 0 {
            found[(link & !LIGHT_LEAF) as usize] += 1;
            continue;
        }
        let pair = &tree.nodes[link as usize..link as usize + 2];
        let power: f32 = pair.iter().map(|n| n.cluster.power).sum();
        assert!((power - cluster.power).abs() <= 1e-5 * power);
        for (below, index) in pair.iter().zip(link..) {
            let inner = &below.cluster;
            let is_leaf = below.link & LIGHT_LEAF != 0;
            let reach = inner.center.distance(cluster.center) + inner.radius;
            let apart = inner.axis.dot(cluster.axis).clamp(-1.0, 1.0).acos();
            assert!(!is_leaf || reach <= 1.001 * cluster.radius + 0.2);
            assert!(!is_leaf || apart <= cluster.cosine.acos() + 1e-3);
            assert_eq!(below.parent, node);
            open.push((below.link, index, *inner, level + 1));
        }
    }
    (deepest, found)
}

#[test]
fn trees_hold_each_item_once_on_few_levels() {
    let spread = |i: u32| Vec3::new((i * 37 % 101) as f32, (i * 53 % 89) as f32, 0.0);
    // Each is as far from the next as all before together, so that planes cut off one at a time.
    let doubling = |i: u32| Vec3::X * 1.9_f32.powi(i as i32);
    let together = |_: u32| Vec3::ONE;
    let cases: [(&dyn Fn(u32) -> Vec3, u32); 4] = [
        (&spread, 3000),
        (&spread, 20_000),
        (&doubling, 100),
        (&together, 3000),
    ];
    for (place, count) in cases {
        let mut leaves: Vec<_> = (0..count).map(|i| leaf(place(i), i)).collect();
        let tree = build(&mut leaves).expect("it has items");
        assert_eq!(tree.nodes.len(), 2 * (count as usize - 1));
        let (levels, found) = checked(&tree, count as usize);
        assert!(levels <= MOST_LEVELS, "{levels}");
        assert!(found.iter().all(|n| *n == 1));
        let mut again: Vec<_> = (0..count).map(|i| leaf(place(i), i)).collect();
        assert_eq!(build(&mut again), Some(tree));
    }
    assert_eq!(build(&mut []), None);
    let one = build(&mut [leaf(Vec3::ONE, 3)]).expect("it has an item");
    assert!(one.nodes.is_empty() && one.link == 3 | LIGHT_LEAF);
}

#[test]
fn packing_widens_what_bounds() {
    for item in 0..200 {
        let mut cluster = leaf(Vec3::new(item as f32, -7.3, 1e4), item).cluster;
        cluster.radius = 0.37 * 1.3_f32.powi(item as i32 - 100);
        cluster.cosine = 1.0 - 0.01 * item as f32;
        let node = Node {
            cluster,
            link: 17,
            parent: 5,
        };
        let read = Node::of_words(node.words());
        assert_eq!((read.link, read.parent), (17, 5));
        let found = &read.cluster;
        assert_eq!((found.center, found.power), (cluster.center, cluster.power));
        assert!(found.radius >= cluster.radius && found.radius <= 1.01 * cluster.radius);
        let off = found.axis.dot(cluster.axis).min(1.0).acos();
        let narrower = cluster.cosine.acos() + off - found.cosine.acos();
        assert!(narrower <= 1e-3 || found.cosine <= -1.0, "{narrower}");
    }
}
