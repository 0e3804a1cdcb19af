"""How each solver is called with its own defaults: once cold, or again with another right side.

A module per package, imported when used. Each gives ``solve(program, **options) -> Answer`` or a class whose
instances hold a solver that is set up: ``Session(program, **options)`` with ``solve()`` and ``update(b)``.
"""
