//! `preview --serve`: the arguments of the page.

use std::path::Path;

use super::{args::PreviewArgs, error::AppError, print_out, shutdown, viewed_scene::viewer};
use reflet_preview::serve::{Port, ServeError, serve};

/// Serves the page until Ctrl-C or SIGTERM.
///
/// # Errors
/// A missing scene, a camera that the scene does not have, no usable GPU, or an address that cannot be listened at.
pub fn page(args: &PreviewArgs) -> Result<(), AppError> {
    let refused = |error| match error {
        ServeError::Session(error) => AppError::from_session(error, args.shaders.is_some()),
        ServeError::Address(text) => AppError::Usage(format!("--serve: {text}")),
    };
    let size = (args.from).size(args.size.as_ref(), args.scene.as_deref())?;
    let address = args.serve.as_deref().filter(|address| !address.is_empty());
    if let (None, Some(path)) = (&args.scene, address.filter(|a| Path::new(a).is_file())) {
        return Err(AppError::Usage(format!(
            "--serve takes an address, and {path} is a file: write it first, as in `reflet preview {path} --serve`"
        )));
    }
    let port = Port::listen(address).map_err(refused)?;
    let (gpu, options) = viewer(args, size.unwrap_or([960, 600]))?;
    shutdown::listen();
    if port.is_open {
        reflet_base::error_line!(
            "warning: other machines can reach this port; whoever has the address with its token sees the scene and \
             can change its text, and the connection is not encrypted"
        );
    }
    print_out(&format!("{}\n", port.url))?;
    serve(gpu, &options, port, &shutdown::is_requested).map_err(refused)
}
