"""The embedded data set: synthetic furnished rooms with people who walk, sit and stand in them."""
