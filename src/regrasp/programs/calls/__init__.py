"""How each solver is called by its own name: laid out, set up, given another right side, solved.

A module per package, imported when used, for back ends and the benchmark alike. Each gives
``layout(program)`` and a class ``Session(data, **options)`` with ``update(data)`` and ``solve() -> Answer``,
which passes on the certificates that the solver hands out.
"""
