//! wgpu without opinions.
