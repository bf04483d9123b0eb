//! Errors of the libraries, and what to do about them in the words of the command line.

use study::case::LoadError;
use study::fit::{Failure, Missing, PlanError, SetupError};
use study::run::{MapError, RunError};
use study::store::{CheckpointError, FolderError, StoreError};
use study::sweep::SweepError;

const NAMES: &str = "; give the path of a case file, or a name from \"arclen list\"";
const ANOTHER: &str = "; give another --out, or --restart to begin anew";

/// An error in the words of the command line.
pub trait Advised {
    /// What happened, and what to do.
    fn advised(&self) -> String;
}

impl Advised for LoadError {
    fn advised(&self) -> String {
        match self {
            LoadError::Missing { .. } => format!("{self}{NAMES}"),
            _ => self.to_string(),
        }
    }
}

impl Advised for SweepError {
    fn advised(&self) -> String {
        match self {
            SweepError::File(error) => error.advised(),
            SweepError::Base { error, .. } if matches!(**error, LoadError::Missing { .. }) => {
                format!("{self}{NAMES}")
            }
            _ => self.to_string(),
        }
    }
}

impl Advised for FolderError {
    fn advised(&self) -> String {
        match self {
            FolderError::Empty => format!("--out: {self}"),
            // the work is done: no option is at fault
            FolderError::Write { .. } => self.to_string(),
            _ => format!("--out {self}"),
        }
    }
}

impl Advised for StoreError {
    fn advised(&self) -> String {
        match self {
            StoreError::Foreign { .. } => format!("{self}{ANOTHER}"),
            StoreError::Missing { .. } => {
                format!("{self}; give the folders that \"arclen sweep\" wrote")
            }
            StoreError::Folder(error) => error.advised(),
            _ => self.to_string(),
        }
    }
}

impl Advised for CheckpointError {
    fn advised(&self) -> String {
        match self {
            CheckpointError::Foreign { .. } => format!("{self}{ANOTHER}"),
            CheckpointError::Unreadable { .. } => {
                format!("{self}; give --restart to begin the diagram anew")
            }
            CheckpointError::Folder(error) => error.advised(),
            _ => self.to_string(),
        }
    }
}

impl Advised for RunError {
    fn advised(&self) -> String {
        match self {
            RunError::Device { .. } => format!("{self}, or say --set device.kind=grip"),
            _ => self.to_string(),
        }
    }
}

impl Advised for MapError {
    fn advised(&self) -> String {
        match self {
            MapError::Run(error) => error.advised(),
            MapError::UnknownKey { .. }
            | MapError::OneParameter { .. }
            | MapError::SameParameter { .. } => format!("--over {self}"),
            _ => self.to_string(),
        }
    }
}

impl Advised for Missing {
    fn advised(&self) -> String {
        let advice = match self {
            Missing::Law => ", or --law NAME, or --law all",
            Missing::SpringConstant => ": --set instrument.spring_constant=\"0.08 N/m\"",
            Missing::Radius => " (or --prior radius=\"1.5 um\":\"0.05 um\")",
            Missing::Noise => ", such as --set instrument.noise=\"50 pN\"",
        };
        format!("{self}{advice}")
    }
}

impl Advised for SetupError {
    fn advised(&self) -> String {
        match self {
            SetupError::Missing(missing) => missing.advised(),
            // each begins with the name of the option
            _ => format!("--{self}"),
        }
    }
}

impl Advised for Failure {
    fn advised(&self) -> String {
        match self {
            Failure::Setup(error) => error.advised(),
            _ => self.to_string(),
        }
    }
}

impl Advised for PlanError {
    fn advised(&self) -> String {
        match self {
            PlanError::Setup(error) => error.advised(),
            _ => self.to_string(),
        }
    }
}
