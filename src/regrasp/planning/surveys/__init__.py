"""What a grasp can do, all told: loci, held directions, sensitivities."""
