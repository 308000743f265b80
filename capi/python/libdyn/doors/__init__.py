"""Doors to optimisers and learners: functions of libdyn, with their derivatives, as functions of another package.

    from libdyn.doors import casadi      # also: jax, torch, crocoddyl, scipy
    aba = casadi.function(model, "aba")  # a casadi.Function of (q, v, tau)

A door imports its package when it is imported itself. tangent needs numpy alone.
"""
