//! The alias table for sampling emissive triangles.

use reflet_gpu::{Gpu, GpuError};
use reflet_world::{World, emitters::Emitter};

use super::texel_array::TexelArray;

/// Parameters of the alias table for shaders.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Emitters {
    /// Number of emissive triangles.
    pub triangles: u32,
    /// Sum of their powers; 0: no triangle is sampled.
    pub power: f32,
}

/// The alias table on the GPU.
#[derive(Clone, Debug)]
pub struct GpuEmitters {
    table: TexelArray,
    /// Parameters of the current table.
    pub emitters: Emitters,
    /// Whether the table may differ from frame to frame.
    pub is_moving: bool,
}

impl GpuEmitters {
    /// Uploads the table of a world; `None` where no surface is sampled as a light.
    ///
    /// # Errors
    /// A wgpu error.
    pub fn new(gpu: &Gpu, world: &World) -> Result<Option<Self>, GpuError> {
        if !world.has_emitters() {
            return Ok(None);
        }
        let count: usize = (world.lighting_instances())
            .map(|(_, i)| world.meshes[i.mesh].triangles.len())
            .sum();
        let mut this = Self {
            table: TexelArray::sized::<[u32; 4]>(gpu, "emitters", count)?,
            emitters: Emitters::default(),
            is_moving: world.has_moving_emitters(),
        };
        this.upload(gpu, world);
        Ok(Some(this))
    }

    /// Uploads the table again, if emitters may have moved.
    pub fn update(&mut self, gpu: &Gpu, world: &World) {
        if self.is_moving {
            self.upload(gpu, world);
        }
    }

    fn upload(&mut self, gpu: &Gpu, world: &World) {
        let emitters = world.emitters();
        let (texels, power) = alias_table(&emitters);
        self.table.write(gpu, 0, &texels);
        self.emitters = Emitters {
            triangles: emitters.len() as u32,
            power,
        };
    }

    /// Binding of the table for shaders.
    pub fn resource(&self) -> wgpu::BindingResource<'_> {
        self.table.resource()
    }

    /// Size in bytes.
    pub fn bytes(&self) -> u64 {
        self.table.size()
    }
}

/// Texels of the alias table, and the sum of all powers. A texel is an instance, a triangle, the bits of the share
/// of the column that is its own, and the index of the texel that has the rest (Vose 1991, "A linear algorithm for
/// generating random numbers with a given distribution").
fn alias_table(emitters: &[Emitter]) -> (Vec<[u32; 4]>, f32) {
    let sum: f64 = emitters.iter().map(|e| f64::from(e.power)).sum();
    let count = emitters.len();
    let mut shares: Vec<f64> = (emitters.iter())
        .map(|e| f64::from(e.power) * count as f64 / sum.max(f64::MIN_POSITIVE))
        .collect();
    let mut aliases: Vec<usize> = (0..count).collect();
    let (mut small, mut large): (Vec<_>, Vec<_>) = (0..count).partition(|i| shares[*i] < 1.0);
    while let (Some(less), Some(more)) = (small.pop(), large.pop()) {
        aliases[less] = more;
        shares[more] -= 1.0 - shares[less];
        if shares[more] < 1.0 {
            small.push(more);
        } else {
            large.push(more);
        }
    }
    // Columns left over by rounding keep their whole share.
    for rest in small.into_iter().chain(large) {
        shares[rest] = 1.0;
    }
    let texel = |(i, e): (usize, &Emitter)| {
        let share = (shares[i] as f32).to_bits();
        [e.instance, e.triangle, share, aliases[i] as u32]
    };
    let texels = emitters.iter().enumerate().map(texel).collect();
    (texels, sum as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triangles_are_chosen_by_their_power() {
        let powers = [0.0_f32, 3.0, 1e-4, 1.0, 0.0, 16.0];
        let emitters: Vec<_> = (powers.iter().zip(0..))
            .map(|(power, triangle)| Emitter {
                instance: 7,
                triangle,
                power: *power,
            })
            .collect();
        let (texels, sum) = alias_table(&emitters);
        let mut found = [0.0_f64; 6];
        for (i, [_, _, share, alias]) in texels.iter().enumerate() {
            let share = f64::from(f32::from_bits(*share));
            found[i] += share / 6.0;
            found[*alias as usize] += (1.0 - share) / 6.0;
        }
        for (found, power) in found.iter().zip(powers) {
            let expected = f64::from(power / sum);
            assert!((found - expected).abs() < 1e-7, "{found}, not {expected}");
        }
    }
}
