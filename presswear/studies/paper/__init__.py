"""The study ``paper``: every scene, number, claim and figure of the paper beside ours."""
