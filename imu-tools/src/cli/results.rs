//! The flags that say how to estimate and where the results go, shared by `imu calibrate` and `imu live`.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use imu_core::allan::Terms;

use super::same_target;
use crate::calibrate::{Calibration, Estimator, FittedTerms, Options};
use crate::error::Error;
use crate::output::Output;
use crate::report::{self, formats::Form};

/// How to estimate, and where the results go.
#[derive(Args, Debug)]
pub(super) struct Results {
    /// Write report.html, allan.svg, allan.png, imu.yaml and allan.csv into this folder, over those there
    #[arg(short, long, value_name = "DIR")]
    pub(super) output: Option<PathBuf>,
    /// Leave nothing out: neither handling and bumps nor the warm-up
    #[arg(long)]
    keep_all: bool,
    /// How to estimate N and K
    #[arg(long, value_enum, default_value_t = EstimatorName::Octaves)]
    estimator: EstimatorName,
    /// What to fit: auto (N and K, and of Q, B and R what the recording asks for), or the letters of all
    /// terms, nk among them: nk, nbk, qnk, nkr ... qnbkr (Q quantisation, N white noise, B bias
    /// instability, K random walk, R ramp)
    #[arg(long, value_name = "TERMS", default_value = "auto", value_parser = fitted_terms)]
    terms: FittedTerms,
    /// Form of imu.yaml, or without -o of what is printed
    #[arg(long, value_enum, value_name = "NAME", conflicts_with = "json")]
    format: Option<FormatName>,
}

/// The files written into a folder.
const RESULTS: [&str; 5] = ["imu.yaml", "allan.csv", "allan.svg", "allan.png", "report.html"];

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum FormatName {
    /// Kalibr's imu.yaml
    Kalibr,
    /// What imu_utils writes
    #[value(name = "imu_utils")]
    ImuUtils,
    /// VINS-Mono and VINS-Fusion
    Vins,
    /// OpenVINS' kalibr_imu_chain.yaml
    Openvins,
    /// ORB-SLAM3's settings
    Orbslam3,
    /// Covariances of sensor_msgs/Imu
    RosCovariance,
}

impl FormatName {
    fn form(self) -> Form {
        match self {
            Self::Kalibr => Form::Kalibr,
            Self::ImuUtils => Form::ImuUtils,
            Self::Vins => Form::Vins,
            Self::Openvins => Form::OpenVins,
            Self::Orbslam3 => Form::OrbSlam3,
            Self::RosCovariance => Form::RosCovariance,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum EstimatorName {
    /// Likelihood of the octaves of τ
    Octaves,
    /// Exact maximum likelihood on block means
    Ml,
    /// The classic reading of slopes -1/2 and +1/2, as kalibr_allan does: to compare
    Slope,
}

/// `auto`, or a letter for each term.
fn fitted_terms(text: &str) -> Result<FittedTerms, String> {
    if text == "auto" {
        return Ok(FittedTerms::Asked);
    }
    let has = |letter: char| text.chars().filter(|c| c.eq_ignore_ascii_case(&letter)).count() == 1;
    let [quantisation, white, bias_instability, walk, rate_ramp] =
        ['q', 'n', 'b', 'k', 'r'].map(has);
    let named = [quantisation, white, bias_instability, walk, rate_ramp];
    let letters = named.into_iter().filter(|named| *named).count();
    if !white || !walk || letters != text.chars().count() {
        return Err(
            "auto, or each of the letters q n b k r once at most, with n and k among them \
                    (nk, nbk, qnbkr, ...)"
                .into(),
        );
    }
    Ok(FittedTerms::Given(Terms { quantisation, bias_instability, rate_ramp }))
}

impl Results {
    /// Two files do not go into a pipe, nor over one of `recordings`.
    pub(super) fn check(&self, recordings: &[PathBuf]) -> Result<(), Error> {
        let Some(folder) = &self.output else { return Ok(()) };
        if folder == Path::new("-") {
            return Err(Error::usage(
                "the results go into a folder, and - is none: name one, or leave -o out",
            ));
        }
        let targets = RESULTS.map(|name| folder.join(name));
        let mut files = recordings.iter().filter(|file| *file != Path::new("-"));
        match files.find(|file| targets.iter().any(|to| same_target(file, to))) {
            Some(file) => Err(Error::usage(format!(
                "{} is the recording itself: write into another folder",
                file.display()
            ))),
            None => Ok(()),
        }
    }

    /// Makes the folder for the results, so that a name that cannot be one is told before hours of work.
    pub(super) fn make_folder(&self) -> Result<(), Error> {
        self.output.as_deref().map_or(Ok(()), |folder| {
            std::fs::create_dir_all(folder).map_err(|e| Error::io("make the folder", folder, e))
        })
    }

    /// The flags as the library takes them.
    pub(super) fn options(&self) -> Result<Options, Error> {
        let two = FittedTerms::Given(Terms::default());
        if self.estimator != EstimatorName::Octaves
            && self.terms != FittedTerms::Asked
            && self.terms != two
        {
            return Err(Error::usage(
                "--terms is for --estimator octaves: the others know N and K only",
            ));
        }
        Ok(Options {
            terms: self.terms,
            keep_all: self.keep_all,
            keep_signal: self.output.is_some(),
            estimator: match self.estimator {
                EstimatorName::Octaves => Estimator::Octaves,
                EstimatorName::Ml => Estimator::MaximumLikelihood,
                EstimatorName::Slope => Estimator::Slope,
            },
            ..Options::default()
        })
    }

    /// Writes the files, where a folder is named for them.
    pub(super) fn write(&self, calibration: &Calibration) -> Result<(), Error> {
        let Some(folder) = &self.output else { return Ok(()) };
        write_into(folder, calibration, self.format.map_or(Form::Kalibr, FormatName::form))
    }

    /// Says what was taken for granted and what is wrong, and prints the table, or the form that was asked
    /// for.
    pub(super) fn say(&self, calibration: &Calibration) -> Result<(), Error> {
        for remark in &calibration.remarks {
            super::say(&format!("imu: {remark}"));
        }
        for warning in &calibration.warnings {
            super::say(&format!("imu: warning: {warning}"));
        }
        match self.format.filter(|_| self.output.is_none()) {
            Some(format) => super::print(&format.form().write(calibration)),
            None => super::print(&report::table::calibration(calibration)),
        }
    }
}

/// Writes the report, its plots, `imu.yaml` and `allan.csv`, all or none of them, into a folder that is
/// made if need be.
pub(super) fn write_into(
    folder: &Path,
    calibration: &Calibration,
    form: Form,
) -> Result<(), Error> {
    std::fs::create_dir_all(folder).map_err(|e| Error::io("make the folder", folder, e))?;
    let allan = report::plot::allan(calibration);
    let contents = [
        form.write(calibration).into_bytes(),
        report::csv::deviations(calibration).into_bytes(),
        allan.svg().into_bytes(),
        allan.png()?,
        report::html::page(calibration).into_bytes(),
    ];
    let mut written = Vec::new();
    for (name, bytes) in RESULTS.iter().zip(contents) {
        let mut output = Output::create(&folder.join(name))?;
        output.write(&bytes)?;
        written.push(output);
    }
    // All are complete before any takes its place.
    written.into_iter().try_for_each(Output::finish)
}
