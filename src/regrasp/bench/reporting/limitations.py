"""What a report of this benchmark does not say."""

LIMITATIONS = (
    "The problems are those of planning contact forces, made by the package that is measured beside the "
    "solvers: small, sparse and well scaled for the most part. They say little of programs of another "
    "kind.",
    "Problems of a family are alike. A share of right answers over all problems weighs families by their "
    "number of problems; the tables by family do not.",
    "An answer is right within ten times the accuracy that was asked for, and within 1e-2 for default "
    "settings: these differ between solvers, and so does what they mean by an accuracy. Read default "
    "settings together with the accuracy that is reached.",
    "Where the truth is a reference solve, it comes from Clarabel at its tightest, with a duality gap that "
    "bounds the error; a solver that shares its method may share its blind spots. Distances from known "
    "answers are given over closed forms and publications only.",
    "Times are of calls from Python around set-up and solve. Data are brought into the form a solver likes "
    "before the clock starts; solvers reached through qpsolvers or cvxpy pay for what these do with them, as "
    "their users do. For the smallest problems even a direct call is the handing over of data rather than "
    "the algorithm.",
    "Accuracies are asked for as absolute tolerances, as qpbenchmark asks, and judged relative to the "
    "answer. Where numbers are small, in the family scaled and with the forces of many fingers, a solver can "
    "do what it was asked and not be right.",
    "One thread on one machine. Solvers that gain from more threads, a GPU or another library of linear "
    "algebra are not seen at their best.",
    "Times of answers that are not right count at the time limit; mean times depend on that limit and on the "
    "shift. Shares of problems do not.",
    "That a program is infeasible counts where a certificate proves it. Clarabel, OSQP, QPALM and SCS hand "
    "certificates out, HiGHS a ray where its presolve does not find out first, PIQP and ProxQP an iterate "
    "that is near one; the others, and all that are called through qpsolvers or cvxpy, have none to show, "
    "however right they are.",
    "An updated solve starts from what the solver keeps, which can mislead it: after an infeasible problem, "
    "or where the old answer still passes its checks, ProxQP has answered wrongly in our trials. The loads "
    "of the family turn slowly and are all held.",
    "The time limit of a solve covers laying out its data and, of an updated one, the solve before it; the "
    "times shown do not.",
    "Performance profiles compare with the best of the solvers shown; the order of two solvers in a "
    "profile can change when a third is taken out.",
    "Memory is the growth of a process's resident set; memory that a solver takes from what was already "
    "there is not seen.",
)
