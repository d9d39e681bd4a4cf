//! Kinds of this crate's errors, which tell who can remove the cause.

use crate::compare::CompareError;
use crate::differential::DifferentialError;
use crate::feature_map::FeatureMapError;
use crate::harmonics::HarmonicsError;
use crate::lee::LeeError;
use crate::linalg::LinalgError;
use crate::multiscale::MultiscaleError;
use crate::normal_filter::NormalFilterError;
use crate::sgwt::SgwtError;
use crate::taubin::TaubinError;
use adwave::bands::BandsError;
use adwave::{ClassifiedError, ErrorKind};

impl ClassifiedError for LinalgError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::NotFinite { .. }
            | Self::OutOfRange { .. }
            | Self::Length { .. }
            | Self::Factorize { .. }
            | Self::DenseEigen { .. }
            | Self::NotConverged { .. }
            | Self::CgNotConverged { .. } => ErrorKind::Input,
            Self::Cancelled(error) => error.kind(),
        }
    }
}

impl ClassifiedError for DifferentialError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Linalg(error) => error.kind(),
            Self::Length { .. } | Self::BadAnchor { .. } | Self::NoAnchor { .. } => ErrorKind::Input,
        }
    }
}

impl ClassifiedError for HarmonicsError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Linalg(error) => error.kind(),
            Self::Length { .. } => ErrorKind::Input,
        }
    }
}

impl ClassifiedError for TaubinError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::PassBand(_) | Self::Iterations { .. } | Self::Factors { .. } => ErrorKind::Input,
            Self::Signal(error) => error.kind(),
        }
    }
}

impl ClassifiedError for SgwtError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Linalg(error) => error.kind(),
            Self::Kernels { .. }
            | Self::Accuracy { .. }
            | Self::Length { .. }
            | Self::NotReversible
            | Self::NoFrame(_) => ErrorKind::Input,
            Self::TooLarge { .. } => ErrorKind::Memory,
        }
    }
}

impl ClassifiedError for LeeError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::NotAMesh => ErrorKind::Input,
            Self::Cancelled(error) => error.kind(),
        }
    }
}

impl ClassifiedError for FeatureMapError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::NotAMesh | Self::Signal { .. } | Self::Time { .. } => ErrorKind::Input,
            Self::Linalg(error) => error.kind(),
        }
    }
}

impl ClassifiedError for MultiscaleError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::TooLarge { .. } => ErrorKind::Memory,
            Self::NotReversible | Self::Params { .. } | Self::Length { .. } | Self::NoRows(_) => {
                ErrorKind::Input
            }
            Self::Linalg(error) => error.kind(),
            Self::Cancelled(error) => error.kind(),
        }
    }
}

impl ClassifiedError for NormalFilterError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::NotAMesh | Self::Parameter { .. } | Self::TooManyFaces { .. } | Self::Normals { .. } => {
                ErrorKind::Input
            }
            Self::Linalg(error) => error.kind(),
            Self::Cancelled(error) => error.kind(),
        }
    }
}

impl ClassifiedError for CompareError {
    fn kind(&self) -> ErrorKind {
        match self {
            Self::Bands(BandsError::Cancelled(_)) => ErrorKind::Cancelled,
            Self::Bands(BandsError::TooLarge { .. }) => ErrorKind::Memory,
            Self::Bands(_)
            | Self::Saliency(_)
            | Self::Features(_)
            | Self::Channels(_)
            | Self::NoRows(_)
            | Self::NoShape(_)
            | Self::NotCoordinates
            | Self::OtherDomain
            | Self::WideKernel { .. }
            | Self::NotMesh => ErrorKind::Input,
            Self::Subdivision(error) => error.kind(),
            Self::Region(error) => error.kind(),
            Self::Harmonics(error) => error.kind(),
            Self::Lee(error) => error.kind(),
            Self::FeatureMap(error) => error.kind(),
            Self::Sgwt(error) => error.kind(),
            Self::Multiscale(error) => error.kind(),
            Self::Taubin(error) => error.kind(),
            Self::NormalFilter(error) => error.kind(),
            Self::Linalg(error) => error.kind(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use adwave::Cancelled;

    #[test]
    fn an_error_inside_another_keeps_its_kind() {
        let stopped = || LinalgError::from(Cancelled);
        assert_eq!(CompareError::from(HarmonicsError::from(stopped())).kind(), ErrorKind::Cancelled);
        assert_eq!(
            CompareError::from(TaubinError::from(DifferentialError::from(stopped()))).kind(),
            ErrorKind::Cancelled
        );
        assert_eq!(CompareError::from(NormalFilterError::from(stopped())).kind(), ErrorKind::Cancelled);
        assert_eq!(CompareError::from(LeeError::NotAMesh).kind(), ErrorKind::Input);
        assert_eq!(SgwtError::TooLarge { n: 9, most: 3 }.kind(), ErrorKind::Memory);
    }
}
