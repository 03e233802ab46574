//! CapsuleExplorer: build and serve.

use crate::command::{command_in, run};
use crate::{notices, root, setup, wasm};
use anyhow::{Context, Result, bail};

#[derive(clap::Args)]
pub struct Options {
    /// Port on 127.0.0.1
    #[arg(long, default_value_t = 4173)]
    port: u16,
    /// Build into wasm/explorer/dist and stop
    #[arg(long)]
    build_only: bool,
}

/// Builds the page and serves it until interrupted.
pub fn explore(options: &Options) -> Result<()> {
    build()?;
    if options.build_only {
        return Ok(());
    }
    let port = options.port;
    std::net::TcpListener::bind(("127.0.0.1", port))
        .with_context(|| format!("port {port} on 127.0.0.1 is taken; choose another with --port"))?;
    println!("CapsuleExplorer: http://127.0.0.1:{port}/  (Ctrl-C ends it)");
    run(&mut command_in(
        &root().join("wasm/explorer"),
        &format!("npx vite preview --host 127.0.0.1 --port {port} --strictPort"),
    ))
}

/// Builds `wasm/explorer/dist`: module, model and page.
pub fn build() -> Result<()> {
    let model = root().join("models/capsule.crom");
    if !model.is_file() {
        bail!(
            "{} is missing: `cargo run --release -p capsule-rom -- offline build` makes it from models/database",
            model.display()
        );
    }
    setup::bring(&[setup::WASM, setup::EXPLORER_MODULES])?;
    wasm::build()?;
    let explorer = root().join("wasm/explorer");
    run(&mut command_in(&explorer, "npm run build"))?;
    // Vite writes the notices of the npm packages that it bundles; the module's crates follow.
    let notices = explorer.join("dist").join(notices::FILE);
    let texts = [notices.clone(), explorer.join("src/wasm").join(notices::FILE)].map(std::fs::read_to_string);
    let [packages, crates] = texts;
    std::fs::write(&notices, format!("{}\n{}", packages?, crates?))
        .with_context(|| format!("could not write {}", notices.display()))
}
