//! The Python extension of softshadow: converts, detaches from the interpreter, maps errors
