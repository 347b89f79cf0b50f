"""Factor graph of a whole walk (GTSAM): its factors, the optimiser, the marginal covariances and the public graph."""
