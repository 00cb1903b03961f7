"""The simulated world: the car, turtlesim's interface and the episode that drives them."""
