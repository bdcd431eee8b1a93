"""The checks. Each compares one quantity of both methods within a tolerance; its verdict is agree, disagree or inconclusive."""
