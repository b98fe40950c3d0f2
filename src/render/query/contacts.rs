//! Things that touch or cut through each other.

use std::collections::BTreeMap;

use super::{
    answer::{Answer, Contact},
    numbers, rounded,
    things::Things,
};
use reflet_world::{World, contact};

/// Number of triangles, and of pairs of near ones, that are looked at.
const MOST_WORK: usize = 3_000_000;

/// Adds the contacts of the chosen things, which the answer lists in the same order.
pub fn find(world: &World, things: &Things, chosen: &[usize], answer: &mut Answer) {
    let mut listed = vec![None; things.len()];
    for (place, thing) in chosen.iter().enumerate() {
        listed[*thing] = Some(place);
    }
    let boxes: Vec<_> = world.instances.iter().map(|i| world.bounds_of(i)).collect();
    let mut order: Vec<usize> = (0..boxes.len()).filter(|i| !boxes[*i].is_empty()).collect();
    order.sort_by(|a, b| boxes[*a].min.x.total_cmp(&boxes[*b].min.x));
    let mut found: BTreeMap<[usize; 2], contact::Contact> = BTreeMap::new();
    let (mut work_left, mut unknown) = (MOST_WORK, 0);
    let mut open: Vec<usize> = Vec::new();
    for index in order {
        // Surfaces that are a little apart touch too.
        let slack = boxes[index].diagonal() * 1e-3;
        open.retain(|other| boxes[*other].max.x + slack >= boxes[index].min.x);
        for other in &open {
            let pair = [*other, index].map(|i| things.of(i));
            let is_asked = pair[0] != pair[1] && pair.iter().any(|thing| listed[*thing].is_some());
            let [a, b] = [&boxes[*other], &boxes[index]];
            let meets = a.min.cmple(b.max + slack).all() && a.max.cmpge(b.min - slack).all();
            if !is_asked || !meets {
                continue;
            }
            match contact::contact(world, [*other, index], &mut work_left) {
                Ok(Some(own)) => {
                    let key = [pair[0].min(pair[1]), pair[0].max(pair[1])];
                    let known = found.entry(key).or_insert(own);
                    if own.depth_m > known.depth_m {
                        *known = own;
                    }
                }
                Ok(None) => {}
                Err(contact::OutOfWork) => unknown += 1,
            }
        }
        open.push(index);
    }
    answer.leave_out(
        unknown,
        "pairs of parts are too detailed to be searched for contacts: ask by --of",
    );
    for ([a, b], own) in found {
        for (thing, other) in [(a, b), (b, a)] {
            if let Some(place) = listed[thing] {
                answer.things[place].contacts.push(Contact {
                    with: things.name(other).to_owned(),
                    cuts: own.depth_m > 0.0,
                    depth_m: rounded(own.depth_m),
                    at_m: numbers(own.at),
                });
            }
        }
    }
    for thing in &mut answer.things {
        thing
            .contacts
            .sort_by(|a, b| b.depth_m.total_cmp(&a.depth_m));
    }
}
