"""One device's samples ─► measurements. The front end knows phones and gait, and nothing of estimators."""
