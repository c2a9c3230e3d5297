//! Soft shadows from area lights, as numbers and as pictures
