//! Work of reading a file, counted as its allocations: unlike time, the same on every machine.

use allocation_counter::{AllocationInfo, measure};
use rayon::ThreadPoolBuilder;

use crate::{kit::*, promises::check_promises};

/// Result of `read` and the allocations that it made. Its parallel parts run on the same thread, so that they are
/// counted too.
pub fn counted<T: Send>(read: impl FnOnce() -> T + Send) -> (T, AllocationInfo) {
    let pool = ThreadPoolBuilder::new().num_threads(1).build();
    pool.expect("a thread").install(|| {
        let mut result = None;
        let work = measure(|| result = Some(read()));
        (result.expect("`measure` calls it"), work)
    })
}

/// Largest work of several reads.
#[derive(Debug, Default)]
pub struct Most {
    bytes: u64,
    allocations: u64,
}

impl Most {
    /// Calls `read`, and keeps its work where it is the largest.
    pub fn keep<T: Send>(&mut self, read: impl FnOnce() -> T + Send) -> T {
        let (result, work) = counted(read);
        self.bytes = self.bytes.max(work.bytes_total);
        self.allocations = self.allocations.max(work.count_total);
        result
    }

    /// Whether a damaged file loads: then its world keeps its promises, otherwise it is refused for a fault of the
    /// file.
    pub fn loads(&mut self, doc: &Doc, what: &str) -> bool {
        match self.keep(|| doc.load()) {
            Ok(world) => {
                check_promises(&world, what);
                true
            }
            Err(errors) => {
                let is_of_file = errors.iter().all(|error| error.name != "internal");
                assert!(is_of_file, "{what}: {errors:?}");
                false
            }
        }
    }

    /// Loads so many documents of damaged files: up to five bytes behind the first `from` are changed in each, and every
    /// seventh is cut; daily a third as many. Of a hundred, the numbers of the refused and the loaded ones.
    pub fn damage(
        &mut self,
        rounds: usize,
        files: &[Vec<u8>],
        from: usize,
        document: impl Fn(&[u8]) -> Doc,
    ) -> [usize; 2] {
        let (mut random, mut counts) = (Random(5), [0; 2]);
        let rounds = if is_long() { rounds } else { rounds / 3 };
        for round in 0..rounds {
            let mut bytes = files[round % files.len()].clone();
            for _ in 0..random.below(6) {
                let at = from + random.below(bytes.len() - from);
                bytes[at] = random.below(256) as u8;
            }
            if round % 7 == 0 {
                bytes.truncate(random.below(bytes.len()));
            }
            let is_loaded = self.loads(&document(&bytes), &round.to_string());
            counts[usize::from(is_loaded)] += 1;
        }
        counts.map(|count| 100 * count / rounds)
    }

    /// Asserts that no read allocated more than this many MiB, in this many allocations.
    #[track_caller]
    pub fn assert_below(&self, mib: u64, allocations: u64) {
        assert!(
            self.bytes < mib << 20 && self.allocations < allocations,
            "{self:?}, expected below {mib} MiB in {allocations}"
        );
    }
}
