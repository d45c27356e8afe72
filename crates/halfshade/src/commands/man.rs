//! `halfshade man`: a manual page.

use crate::{
    cli::{Cli, ManArguments},
    failure::Failure,
    terminal,
};
use clap::CommandFactory;
use halfshade_scene::text::unknown;
use std::process::ExitCode;

pub(super) fn man(arguments: &ManArguments) -> Result<ExitCode, Failure> {
    let mut command = Cli::command();
    // Arguments of every command are copied into each of them.
    command.build();
    if let Some(name) = &arguments.command {
        let names: Vec<String> = command.get_subcommands().map(|it| it.get_name().to_owned()).collect();
        let unknown = || Failure::Error(unknown("command", name, names.iter().map(String::as_str)));
        let found = command.find_subcommand(name).ok_or_else(unknown)?;
        command = found.clone();
    }
    let mut page = Vec::new();
    clap_mangen::Man::new(command).render(&mut page).map_err(|error| Failure::Error(error.to_string()))?;
    terminal::data(&String::from_utf8_lossy(&page))?;
    Ok(ExitCode::SUCCESS)
}
