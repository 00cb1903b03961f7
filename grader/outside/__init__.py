"""Other people's servers that the service speaks to: where accounts, courses and messages live.

`signin` asks identity providers who somebody is (OpenID Connect, CAS, a trusted header). `lti` exchanges launches,
class lists and scores with learning platforms. `notices` sends messages to group chats and by e-mail. What they
receive is checked here; what follows from it is decided in `grader.use_cases`.
"""
