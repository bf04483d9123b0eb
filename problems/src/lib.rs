//! Catalogue of problems with known answers.
