"""A benchmark of QP and conic solvers on contact-force problems whose answers are known."""
