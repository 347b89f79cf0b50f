"""Extended Kalman filter of all devices of a walk, offline and online, and its Rauch-Tung-Striebel smoother."""
